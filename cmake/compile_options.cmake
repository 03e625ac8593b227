# orb360_compile_options: what every target of the project is compiled with. There is no -march:
# speed comes from run-time dispatch, and another instruction set would change Eigen's alignment
# against that of the installed libraries. There is no contraction, so that every build does the
# same arithmetic.
add_library(orb360_compile_options INTERFACE)
target_compile_options(orb360_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off
  $<$<BOOL:${ORB360_WERROR}>:-Werror>)

# Private headers lie beside their sources, public ones in include/orb360/.
target_include_directories(orb360_compile_options INTERFACE ${PROJECT_SOURCE_DIR})

# This is Eigen's own guess except under AddressSanitizer, where Eigen would free in another way
# what OpenGV has allocated.
target_compile_definitions(orb360_compile_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)

# Vectors of unknown length cannot be members of arrays and structures: Arm gets NEON.
target_compile_definitions(orb360_compile_options INTERFACE
  "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
