#include "slam/scale/scale_smoother.h"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(SmoothScale, IsTheLeastSquaresSolutionOfTheWholeChain) {
  const std::vector<ScaleNode> nodes = {{0.0, 1.0, 0.010, 0.020},
                                        {2.0, 1e-4, 0.0, 0.0},
                                        {1.0, 4e-4, -0.005, 0.010},
                                        {3.0, 2e-4, 0.012, 0.030},
                                        {1.0, 1e-4, 0.0, 0.0}};
  // The same by a dense matrix. No residual is an outlier, and all are smaller than stated.
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(5);
  Eigen::VectorXd share(5);
  for (int i = 0; i < 5; ++i) {
    share[i] = nodes[i].path_length / 7.0;
    if (nodes[i].sigma > 0) {
      information(i, i) += std::pow(nodes[i].sigma, -2);
      right[i] += nodes[i].measured * std::pow(nodes[i].sigma, -2);
    }
    if (i == 0) continue;
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(5);
    difference[i] = 1;
    difference[i - 1] = -1;
    information += difference * difference.transpose() / nodes[i].drift_variance;
  }
  const Eigen::MatrixXd covariance = information.inverse();
  const Eigen::VectorXd expected = covariance * right;
  const auto found = SmoothScale(nodes);
  ASSERT_TRUE(found);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(found->log_scale[i], expected[i], 1e-12) << i;
    EXPECT_NEAR(found->sigma[i], std::sqrt(covariance(i, i)), 1e-12) << i;
  }
  EXPECT_NEAR(found->mean, share.dot(expected), 1e-12);
  EXPECT_NEAR(found->mean_sigma, std::sqrt(share.dot(covariance * share)), 1e-12);
}

TEST(SmoothScale, ErrorsAreAsLargeAsItsStandardDeviationsSay) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double of_nodes = 0;
  double of_mean = 0;
  constexpr int kTrials = 300;
  constexpr int kNodes = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<ScaleNode> nodes(kNodes);
    std::vector<double> truth(kNodes);
    double x = 0.1 * normal(random);
    double mean = 0;
    for (int i = 0; i < kNodes; ++i) {
      nodes[i].path_length = 1.0;
      nodes[i].drift_variance = 1e-4;
      if (i > 0) x += 0.01 * normal(random);
      truth[i] = x;
      mean += x / kNodes;
      // Nothing is seen in the middle of the path.
      if (i % 3 != 0 || (i > 10 && i < 30)) continue;
      nodes[i].sigma = 0.02;
      nodes[i].measured = x + 0.02 * normal(random);
    }
    const auto found = SmoothScale(nodes);
    ASSERT_TRUE(found);
    EXPECT_GT(found->sigma[20], 1.5 * found->sigma[3]);
    for (int i = 0; i < kNodes; ++i) {
      of_nodes += std::pow((found->log_scale[i] - truth[i]) / found->sigma[i], 2);
    }
    of_mean += std::pow((found->mean - mean) / found->mean_sigma, 2);
  }
  EXPECT_NEAR(of_nodes / (kTrials * kNodes), 0.9, 0.2);
  EXPECT_NEAR(of_mean / kTrials, 0.9, 0.2);
}

TEST(SmoothScale, AnOutlierMovesItLittleAndAContradictionWidensIt) {
  std::vector<ScaleNode> nodes(21, {1.0, 1e-6, 0.0, 0.01});
  const auto agreed = SmoothScale(nodes);
  nodes[10].measured = 2.0;
  const auto with_outlier = SmoothScale(nodes);
  EXPECT_LT(std::abs(with_outlier->mean), 0.002);
  for (size_t i = 0; i < nodes.size(); ++i) nodes[i].measured = i % 2 == 0 ? 0.1 : -0.1;
  const auto contradicting = SmoothScale(nodes);
  EXPECT_GT(contradicting->mean_sigma, 4 * agreed->mean_sigma);
}

TEST(SmoothScale, DriftLargerThanStatedWidensIt) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<ScaleNode> nodes(41, {1.0, 1e-4, 0.0, 1e-4});
  const auto agreed = SmoothScale(nodes);
  // Measurements are exact, so that the scale follows them; only its steps are ten times too large.
  double x = 0;
  for (ScaleNode& node : nodes) node.measured = x += 0.1 * normal(random);
  const auto drifting = SmoothScale(nodes);
  EXPECT_NEAR(drifting->mean_sigma / agreed->mean_sigma, 10, 3);
}

TEST(SmoothScale, TheSpreadIsHowFarMeasurementsVaryBeyondTheirErrors) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  // The path holds together, so that the scale cannot follow the measurements.
  std::vector<ScaleNode> nodes(60, {1.0, 1e-8, 0.0, 0.05});
  for (ScaleNode& node : nodes) node.measured = node.sigma * normal(random);
  EXPECT_LT(SmoothScale(nodes)->spread, 0.01);
  // Single outliers count for nothing.
  for (size_t i = 3; i < 60; i += 9) nodes[i].measured = 2;
  EXPECT_LT(SmoothScale(nodes)->spread, 0.03);
  // A third of the path was seen from a height twenty times as large.
  for (size_t i = 40; i < 60; ++i) nodes[i].measured -= std::log(20.0);
  EXPECT_NEAR(SmoothScale(nodes)->spread, std::log(20.0) / std::sqrt(3.0), 0.2);
}

TEST(SmoothScale, TheSpreadIsThatOfMeasuredNodesWithAndWithoutLength) {
  // Each second node is measured: ten of them 0, and ten 1.
  std::vector<ScaleNode> nodes(40, {0.0, 1e-8, 0.0, 0.0});
  for (size_t i = 0; i < nodes.size(); i += 2) {
    nodes[i].sigma = 0.01;
    nodes[i].measured = i < 20 ? 0 : 1;
  }
  EXPECT_NEAR(SmoothScale(nodes)->spread, 0.5, 0.02);
  // Of what lies along a path only its second half counts; the mean of all is half-way still.
  for (size_t i = 20; i < 40; ++i) nodes[i].path_length = 1;
  EXPECT_NEAR(SmoothScale(nodes)->spread, 0.5, 0.02);
  // Fewer than five measurements tell nothing of how they vary.
  EXPECT_EQ(SmoothScale(std::vector<ScaleNode>{{1, 1e-8, 0, 0.01}, {1, 1e-8, 2, 0.01}})->spread, 0);
}

TEST(SmoothScale, IsEmptyWhereNothingWasMeasured) {
  EXPECT_FALSE(SmoothScale({}));
  EXPECT_FALSE(SmoothScale(std::vector<ScaleNode>(4, {1.0, 1e-4, 0.0, 0.0})));
  // One measurement tells about the whole path.
  const auto found = SmoothScale(std::vector<ScaleNode>{{0, 1, 0, 0}, {1, 1e-4, 0.3, 0.02}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->log_scale[0], 0.3, 1e-12);
  EXPECT_NEAR(found->sigma[0], std::hypot(0.02, 0.01), 1e-12);
}

}  // namespace
}  // namespace orb360
