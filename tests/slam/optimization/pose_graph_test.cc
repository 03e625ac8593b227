#include "slam/optimization/pose_graph.h"

#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "tests/slam/optimization/circle_graph.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

double Error(const Similarity3& a, const Similarity3& b) {
  return (a.translation - b.translation).norm() + a.rotation.angularDistance(b.rotation) +
         std::abs(std::log(a.scale / b.scale));
}

class PoseGraphTest : public testing::TestWithParam<Optimizer> {
 protected:
  PoseGraphOptions options() const { return {.optimizer = GetParam()}; }
};

INSTANTIATE_TEST_SUITE_P(Optimizers, PoseGraphTest,
                         testing::Values(Optimizer::kSchur, Optimizer::kCeres),
                         [](const testing::TestParamInfo<Optimizer>& optimizer) {
                           return kOptimizerNames[static_cast<size_t>(optimizer.param)];
                         });

TEST_P(PoseGraphTest, ExactEdgesGiveTheTruthFromADisturbedStart) {
  const std::vector<Similarity3> truth = Circle(30);
  PoseGraph graph = Chain(truth, {});
  graph.edges.push_back({29, 0, truth[29].Inverse() * truth[0], 1.0});
  for (int i = 1; i < 30; ++i) {
    graph.world_from_node[i].translation += Eigen::Vector3d(0.3, -0.2, 0.1) * (i % 3);
    graph.world_from_node[i].scale *= 1.0 + 0.02 * (i % 4);
    graph.world_from_node[i].rotation = ExpSo3({0.05, 0.02, -0.1}) * truth[i].rotation;
  }
  ASSERT_TRUE(SolvePoseGraph(options(), &graph).usable);
  for (int i = 0; i < 30; ++i) EXPECT_LT(Error(graph.world_from_node[i], truth[i]), 1e-6) << i;
}

// 30 % of scale and 17 degrees lost on the way round: the loop's edge brings them back.
TEST_P(PoseGraphTest, ALoopSpreadsTheDriftOfScaleAndDirectionOverTheWay) {
  const std::vector<Similarity3> truth = Circle(60);
  PoseGraph graph = Chain(truth, {std::exp(0.3 / 60), ExpSo3({0, 0, 0.3 / 60}), {0, 0, 0.01}});
  double before = 0;
  for (int i = 0; i < 60; ++i) before = std::max(before, Error(graph.world_from_node[i], truth[i]));
  EXPECT_GT(before, 3.0);
  graph.unit = 5.0;
  graph.edges.push_back({0, 59, truth[0].Inverse() * truth[59], 100.0});
  ASSERT_TRUE(SolvePoseGraph(options(), &graph).usable);
  // Both ends meet, and in between nothing is bent more than the drift of a few steps.
  EXPECT_LT(Error(graph.world_from_node[59], truth[59]), 0.02);
  for (int i = 1; i < 60; ++i) {
    const Similarity3 step = graph.world_from_node[i - 1].Inverse() * graph.world_from_node[i];
    EXPECT_LT(Error(step, graph.edges[i - 1].first_from_second), 0.05) << i;
  }
}

TEST_P(PoseGraphTest, AHeavierEdgeBendsLess) {
  PoseGraph graph;
  graph.world_from_node = {{}, {1.0, Eigen::Quaterniond::Identity(), {1.5, 0, 0}}};
  graph.fixed = {1, 0};
  graph.edges = {{0, 1, {1.0, Eigen::Quaterniond::Identity(), {1, 0, 0}}, 3.0},
                 {0, 1, {1.0, Eigen::Quaterniond::Identity(), {2, 0, 0}}, 1.0}};
  ASSERT_TRUE(SolvePoseGraph(options(), &graph).usable);
  EXPECT_NEAR(graph.world_from_node[1].translation.x(), 1.25, 1e-4);  // the weighted mean
}

TEST_P(PoseGraphTest, ContractsAreChecked) {
  PoseGraph graph;
  graph.world_from_node = {{}, {}};
  graph.fixed = {1};
  EXPECT_THROW(SolvePoseGraph(options(), &graph), ContractError);
}

// One free node with two edges: the minimum of a weighted sum of squares in closed form.
TEST_P(PoseGraphTest, TheScaleIsTheWeightedGeometricMean) {
  PoseGraph graph;
  graph.world_from_node = {{}, {}};
  graph.fixed = {1, 0};
  for (const auto& [scale, weight] : {std::pair{1.5, 1.0}, {0.8, 3.0}}) {
    graph.edges.push_back(
        {.first = 0, .second = 1, .first_from_second = {.scale = scale}, .weight = weight});
  }
  const SolverReport report = SolvePoseGraph(options(), &graph);
  const double log_scale = (std::log(1.5) + 3 * std::log(0.8)) / 4;
  EXPECT_NEAR(std::log(graph.world_from_node[1].scale), log_scale, 1e-5);
  EXPECT_NEAR(
      report.final_cost,
      0.5 * (std::pow(std::log(1.5) - log_scale, 2) + 3 * std::pow(std::log(0.8) - log_scale, 2)),
      1e-9);
}

TEST_P(PoseGraphTest, ANodeWithoutEdgesAndAGraphWithoutFreeNodesStayAsTheyAre) {
  PoseGraph graph = Chain(Circle(5), {});
  const Similarity3 alone{2.0, ExpSo3({0.1, 0.2, 0.3}), {1, 2, 3}};
  graph.world_from_node.push_back(alone);
  graph.fixed.push_back(0);
  graph.world_from_node[2].translation.x() += 0.1;
  ASSERT_TRUE(SolvePoseGraph(options(), &graph).usable);
  EXPECT_LT(Error(graph.world_from_node.back(), alone), 1e-12);
  graph.fixed.assign(graph.fixed.size(), 1);
  EXPECT_TRUE(SolvePoseGraph(options(), &graph).usable);
}

TEST_P(PoseGraphTest, GivesTheSameBitsTwice) {
  PoseGraph graph = Laps(1, 2, 30, 1e4);
  PoseGraph again = graph;
  SolvePoseGraph(options(), &graph);
  SolvePoseGraph(options(), &again);
  for (size_t i = 0; i < graph.world_from_node.size(); ++i) {
    EXPECT_EQ(graph.world_from_node[i].translation, again.world_from_node[i].translation);
    EXPECT_EQ(graph.world_from_node[i].scale, again.world_from_node[i].scale);
  }
}

TEST_P(PoseGraphTest, ANodeThatIsNotFiniteLeavesTheGraphAsItIs) {
  PoseGraph graph = Chain(Circle(5), {});
  graph.world_from_node[3].translation.x() = std::numeric_limits<double>::quiet_NaN();
  const PoseGraph before = graph;
  EXPECT_FALSE(SolvePoseGraph(options(), &graph).usable);
  EXPECT_EQ(graph.world_from_node[2].translation, before.world_from_node[2].translation);
}

// Ceres differentiates the edges by itself: independent truth.
TEST(PoseGraphOptimizers, ComeToTheSameMinimum) {
  for (int seed = 1; seed <= 5; ++seed) {
    PoseGraph own = Laps(seed, 1 + seed, 40, 1e4);
    PoseGraph other = own;
    PoseGraphOptions options{.max_iterations = 200, .function_tolerance = 1e-12};
    const SolverReport by_schur = SolvePoseGraph(options, &own);
    options.optimizer = Optimizer::kCeres;
    const SolverReport by_ceres = SolvePoseGraph(options, &other);
    ASSERT_TRUE(by_schur.usable && by_ceres.usable);
    EXPECT_NEAR(by_schur.initial_cost, by_ceres.initial_cost, 1e-9 * by_ceres.initial_cost);
    EXPECT_LT(by_schur.final_cost, 0.1 * by_schur.initial_cost);
    EXPECT_NEAR(by_schur.final_cost, by_ceres.final_cost, 1e-8 * by_ceres.final_cost);
    for (size_t i = 0; i < own.world_from_node.size(); ++i) {
      EXPECT_LT(Error(own.world_from_node[i], other.world_from_node[i]), 1e-5) << i;
    }
  }
}

TEST(PoseGraphOptimizers, ComeEquallyFarByTheStoppingRuleOfLoopClosing) {
  for (int seed = 1; seed <= 5; ++seed) {
    PoseGraph own = Laps(seed, 3, 60, 1e5);
    PoseGraph other = own;
    const SolverReport by_schur = SolvePoseGraph({}, &own);
    const SolverReport by_ceres = SolvePoseGraph({.optimizer = Optimizer::kCeres}, &other);
    EXPECT_EQ(by_schur.iterations, by_ceres.iterations);
    EXPECT_NEAR(by_schur.final_cost, by_ceres.final_cost, 1e-6 * by_ceres.final_cost);
  }
}

}  // namespace
}  // namespace orb360
