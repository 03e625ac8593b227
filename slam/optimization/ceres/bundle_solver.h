#pragma once

#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {

/// SolveBundle by Ceres: SPARSE_SCHUR with Eigen's sparse Cholesky factorization, on one thread and
/// without a limit of time, so that results are the same every time.
SolverReport SolveBundleCeres(const BundleOptions& options, BundleProblem* problem);

}  // namespace orb360
