#pragma once

namespace orb360 {

/// How the minimization of a cost ended.
struct SolverReport {
  double initial_cost = 0;
  double final_cost = 0;
  int iterations = 0;
  /// False where the solver failed numerically; the problem is then unchanged.
  bool usable = false;
};

}  // namespace orb360
