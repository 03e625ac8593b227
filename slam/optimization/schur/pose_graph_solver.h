#pragma once

#include "slam/optimization/pose_graph.h"

namespace orb360 {

/// SolvePoseGraph by the own solver: Levenberg-Marquardt steps with the block Cholesky
/// factorization of the whole Hessian, since a pose graph has no points to eliminate.
SolverReport SolvePoseGraphSchur(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace orb360
