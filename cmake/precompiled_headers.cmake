# Half of the compilation of an average file is the parsing of Eigen and of OpenCV's core
# (docs/results/build_time.md). These are parsed once for a target. CLI11 is not among them: it
# defines objects, for which every file would make code.
set(orb360_slam_headers <algorithm> <cmath> <filesystem> <functional> <map> <memory> <optional>
                        <span> <string> <vector> <Eigen/Core> <Eigen/Geometry> <opencv2/core.hpp>)

# orb360_precompile_headers(TARGET HEADER...)
function(orb360_precompile_headers target)
  if(ORB360_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE ${ARGN})
    # A time stamp in clang's file would make every build another one for ccache.
    target_compile_options(${target} PRIVATE
      "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>"
      $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  endif()
endfunction()
