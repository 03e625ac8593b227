#pragma once

#include "slam/optimization/pose_graph.h"

namespace orb360 {

/// SolvePoseGraph by Ceres with automatic derivatives: SPARSE_NORMAL_CHOLESKY with Eigen's sparse
/// Cholesky factorization, on one thread and without a limit of time.
SolverReport SolvePoseGraphCeres(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace orb360
