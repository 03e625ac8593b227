#pragma once

#include <array>

namespace orb360 {

class OptionSchema;

/// The solver of bundle adjustment problems and pose graphs. Both minimize the same cost with the
/// same damping and stopping rule, on one thread, and give the same bytes every time.
enum class Optimizer {
  kSchur,  ///< The library's own solver, which is several times as fast.
  kCeres,  ///< Ceres, to compare with.
};

/// Names of the optimizers in a configuration file, in the order of the enumeration.
inline constexpr std::array<const char*, 2> kOptimizerNames = {"schur", "ceres"};

/// Registers the key `optimizer`.
void RegisterOptions(OptionSchema* schema, Optimizer* optimizer);

}  // namespace orb360
