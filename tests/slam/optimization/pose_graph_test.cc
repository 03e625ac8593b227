#include "slam/optimization/pose_graph.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "nn/base/check.h"

namespace orb360 {
namespace {

// Cameras on a circle of radius 10, looking along it, whose surroundings have the same scale.
std::vector<Similarity3> Circle(int count) {
  std::vector<Similarity3> nodes;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Eigen::Quaterniond turn = ExpSo3({0, 0, angle});
    nodes.push_back({1.0, turn, turn * Eigen::Vector3d(0, 10, 0)});
  }
  return nodes;
}

double Error(const Similarity3& a, const Similarity3& b) {
  return (a.translation - b.translation).norm() + a.rotation.angularDistance(b.rotation) +
         std::abs(std::log(a.scale / b.scale));
}

PoseGraph Chain(const std::vector<Similarity3>& nodes, const Similarity3& drift_per_step) {
  PoseGraph graph;
  graph.world_from_node = {nodes.front()};
  for (size_t i = 1; i < nodes.size(); ++i) {
    const Similarity3 step = nodes[i - 1].Inverse() * nodes[i] * drift_per_step;
    graph.edges.push_back({static_cast<int>(i) - 1, static_cast<int>(i), step, 1.0});
    graph.world_from_node.push_back(graph.world_from_node.back() * step);
  }
  graph.fixed.assign(nodes.size(), 0);
  graph.fixed.front() = 1;
  return graph;
}

TEST(PoseGraph, ExactEdgesGiveTheTruthFromADisturbedStart) {
  const std::vector<Similarity3> truth = Circle(30);
  PoseGraph graph = Chain(truth, {});
  graph.edges.push_back({29, 0, truth[29].Inverse() * truth[0], 1.0});
  for (int i = 1; i < 30; ++i) {
    graph.world_from_node[i].translation += Eigen::Vector3d(0.3, -0.2, 0.1) * (i % 3);
    graph.world_from_node[i].scale *= 1.0 + 0.02 * (i % 4);
    graph.world_from_node[i].rotation = ExpSo3({0.05, 0.02, -0.1}) * truth[i].rotation;
  }
  ASSERT_TRUE(SolvePoseGraph(&graph));
  for (int i = 0; i < 30; ++i) EXPECT_LT(Error(graph.world_from_node[i], truth[i]), 1e-6) << i;
}

// 30 % of scale and 17 degrees lost on the way round: the loop's edge brings them back.
TEST(PoseGraph, ALoopSpreadsTheDriftOfScaleAndDirectionOverTheWay) {
  const std::vector<Similarity3> truth = Circle(60);
  PoseGraph graph = Chain(truth, {std::exp(0.3 / 60), ExpSo3({0, 0, 0.3 / 60}), {0, 0, 0.01}});
  double before = 0;
  for (int i = 0; i < 60; ++i) before = std::max(before, Error(graph.world_from_node[i], truth[i]));
  EXPECT_GT(before, 3.0);
  graph.unit = 5.0;
  graph.edges.push_back({0, 59, truth[0].Inverse() * truth[59], 100.0});
  ASSERT_TRUE(SolvePoseGraph(&graph));
  // Both ends meet, and in between nothing is bent more than the drift of a few steps.
  EXPECT_LT(Error(graph.world_from_node[59], truth[59]), 0.02);
  for (int i = 1; i < 60; ++i) {
    const Similarity3 step = graph.world_from_node[i - 1].Inverse() * graph.world_from_node[i];
    EXPECT_LT(Error(step, graph.edges[i - 1].first_from_second), 0.05) << i;
  }
}

TEST(PoseGraph, AHeavierEdgeBendsLess) {
  PoseGraph graph;
  graph.world_from_node = {{}, {1.0, Eigen::Quaterniond::Identity(), {1.5, 0, 0}}};
  graph.fixed = {1, 0};
  graph.edges = {{0, 1, {1.0, Eigen::Quaterniond::Identity(), {1, 0, 0}}, 3.0},
                 {0, 1, {1.0, Eigen::Quaterniond::Identity(), {2, 0, 0}}, 1.0}};
  ASSERT_TRUE(SolvePoseGraph(&graph));
  EXPECT_NEAR(graph.world_from_node[1].translation.x(), 1.25, 1e-4);  // the weighted mean
}

TEST(PoseGraph, ContractsAreChecked) {
  PoseGraph graph;
  graph.world_from_node = {{}, {}};
  graph.fixed = {1};
  EXPECT_THROW(SolvePoseGraph(&graph), ContractError);
}

}  // namespace
}  // namespace orb360
