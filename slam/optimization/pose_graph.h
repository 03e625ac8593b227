#pragma once

#include <cstdint>
#include <vector>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// Relative poses between cameras. A map without a metric measurement drifts in scale as well as in
/// position, so that nodes and edges are similarities (Strasdat, Montiel, Davison, Scale
/// Drift-Aware Large Scale Monocular SLAM, RSS 2010).
struct PoseGraph {
  struct Edge {
    int first;  // index of a node
    int second;
    Similarity3 first_from_second;  // as measured
    double weight;                  // of the squared residuals
  };
  std::vector<Similarity3> world_from_node;
  std::vector<uint8_t> fixed;  // by node; at least one
  std::vector<Edge> edges;
  /// Length of an error of translation that weighs as much as a rotation by one radian and as a
  /// scale by e: the range of what the cameras see.
  double unit = 1.0;
};

/// Moves the nodes that are not fixed to the minimum of the edges' squared errors, in place, with
/// Ceres on one thread. False where that fails numerically; then no node has moved.
bool SolvePoseGraph(PoseGraph* graph);

}  // namespace orb360
