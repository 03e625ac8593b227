#pragma once

#include <cstdint>
#include <vector>

#include "slam/optimization/solver_report.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

/// Relative poses between cameras. A map without a metric measurement drifts in scale as well as in
/// position, so that nodes and edges are similarities (Strasdat, Montiel, Davison, Scale
/// Drift-Aware Large Scale Monocular SLAM, RSS 2010).
struct PoseGraph {
  struct Edge {
    /// Indices of two nodes.
    int first;
    int second;
    Similarity3 first_from_second;  ///< The measurement.
    double weight;                  ///< Factor of the squared residuals.
  };
  std::vector<Similarity3> world_from_node;
  /// By node. At least one node is fixed, since the gauge is free otherwise.
  std::vector<uint8_t> fixed;
  std::vector<Edge> edges;
  /// Length of an error of translation that weighs as much as a rotation by one radian and as a
  /// scale by e: the range of what the cameras see.
  double unit = 1.0;
};

struct PoseGraphOptions {
  int max_iterations = 30;
  /// The solver stops when an iteration changes the cost by less than this fraction ...
  double function_tolerance = 1e-6;
  /// ... when no component of the gradient is larger ...
  double gradient_tolerance = 1e-10;
  /// ... or when the norm of the step is less than this fraction of the norm of all parameters.
  double parameter_tolerance = 1e-8;
  Optimizer optimizer = Optimizer::kSchur;
};

/// Moves the nodes that are not fixed to the minimum of half the sum of the edges' weighted squared
/// errors, in place and on one thread. The error of an edge is that of second_from_first *
/// first_from_second: rotation, translation over `unit` and logarithm of the scale.
/// Contract: the nodes and edges are consistent and `unit` is positive.
SolverReport SolvePoseGraph(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace orb360
