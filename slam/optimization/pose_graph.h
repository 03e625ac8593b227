#pragma once

#include <cstdint>
#include <vector>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// Cameras with a scale of their own, and what is known of pairs of them. A map without a metric
/// measure drifts in scale as well as in place; so nodes and edges are similarities (Strasdat,
/// Montiel, Davison, Scale Drift-Aware Large Scale Monocular SLAM, RSS 2010).
struct PoseGraph {
  struct Edge {
    int first;  // nodes
    int second;
    Similarity3 first_from_second;
    double weight;  // of its squared residuals
  };
  std::vector<Similarity3> world_from_node;
  std::vector<uint8_t> fixed;  // by node; at least one
  std::vector<Edge> edges;
  /// A length that weighs as much as a turn by one radian and a scale of e: the range of what the
  /// cameras see.
  double unit = 1.0;
};

/// Moves the free nodes to the least sum of squared errors of the edges, in place, with Ceres on
/// one thread. False, and nothing moved, where that fails numerically.
bool SolvePoseGraph(PoseGraph* graph);

}  // namespace orb360
