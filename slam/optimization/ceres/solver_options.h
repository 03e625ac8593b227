#pragma once

#include <algorithm>

#include <ceres/solver.h>

#include "slam/optimization/solver_report.h"

namespace orb360 {

/// Options with which Ceres gives the same result every time. With several threads it adds blocks
/// of the Schur complement in the order of arrival; a limit of time would make the number of
/// iterations depend on the machine's load.
inline ceres::Solver::Options DeterministicSolverOptions() {
  ceres::Solver::Options options;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.max_solver_time_in_seconds = 1e9;
  options.logging_type = ceres::SILENT;
  return options;
}

inline SolverReport ToReport(const ceres::Solver::Summary& summary) {
  return {.initial_cost = summary.initial_cost,
          .final_cost = summary.final_cost,
          // Ceres leaves the iteration that finds the minimum out of its list of iterations.
          .iterations = std::max(0, summary.num_linear_solves),
          .usable = summary.IsSolutionUsable()};
}

}  // namespace orb360
