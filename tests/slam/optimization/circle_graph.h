#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "slam/optimization/pose_graph.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {

/// Cameras on a circle of radius 10 that look along it, all of the same scale.
inline std::vector<Similarity3> Circle(int count) {
  std::vector<Similarity3> nodes;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Eigen::Quaterniond rotation = ExpSo3({0, 0, angle});
    nodes.push_back({1.0, rotation, rotation * Eigen::Vector3d(0, 10, 0)});
  }
  return nodes;
}

/// A graph whose edges link neighbouring nodes, with a drift in each, and whose nodes follow them.
inline PoseGraph Chain(const std::vector<Similarity3>& nodes, const Similarity3& drift_per_step) {
  PoseGraph graph;
  graph.world_from_node = {nodes.front()};
  for (size_t i = 1; i < nodes.size(); ++i) {
    const Similarity3 step = nodes[i - 1].Inverse() * nodes[i] * drift_per_step;
    graph.edges.push_back({.first = static_cast<int>(i) - 1,
                           .second = static_cast<int>(i),
                           .first_from_second = step,
                           .weight = 1.0});
    graph.world_from_node.push_back(graph.world_from_node.back() * step);
  }
  graph.fixed.assign(nodes.size(), 0);
  graph.fixed.front() = 1;
  return graph;
}

/// Laps around the circle with random drift in all seven directions; nodes that pass the same place
/// in different laps are linked by exact edges of `loop_weight`.
inline PoseGraph Laps(int seed, int laps, int nodes_per_lap, double loop_weight) {
  RandomGeometry random(seed);
  const std::vector<Similarity3> lap = Circle(nodes_per_lap);
  PoseGraph graph;
  std::vector<Similarity3> truth;
  for (int i = 0; i < laps; ++i) truth.insert(truth.end(), lap.begin(), lap.end());
  graph.world_from_node = {truth.front()};
  for (size_t i = 1; i < truth.size(); ++i) {
    const Similarity3 drift{std::exp(random.Normal(0.002)), random.Rotation(0.004),
                            random.Point(0.0, 0.02)};
    const auto node = static_cast<int>(i);
    graph.world_from_node.push_back(graph.world_from_node.back() * truth[i - 1].Inverse() *
                                    truth[i] * drift);
    // As covisibility gives them: to a few nodes before, with the drift in common.
    for (int j = std::max(0, node - 4); j < node; ++j) {
      graph.edges.push_back(
          {.first = j,
           .second = node,
           .first_from_second = graph.world_from_node[j].Inverse() * graph.world_from_node[i],
           .weight = random.Uniform(30.0, 300.0)});
    }
    if (node >= nodes_per_lap && node % 7 == 0) {
      const int before = node - nodes_per_lap;
      graph.edges.push_back({.first = before,
                             .second = node,
                             .first_from_second = truth[before].Inverse() * truth[i],
                             .weight = loop_weight});
    }
  }
  graph.fixed.assign(truth.size(), 0);
  graph.fixed.front() = 1;
  graph.unit = 5.0;
  return graph;
}

}  // namespace orb360
