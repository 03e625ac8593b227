#include "slam/geometry/cluster_weights.h"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

using Bearings = std::vector<Eigen::Vector3d>;

std::vector<uint8_t> All(const Bearings& bearings) {
  return std::vector<uint8_t>(bearings.size(), 1);
}

TEST(ClusterWeights, BearingsFarApartCountInFull) {
  Bearings axes;
  for (int i = 0; i < 3; ++i) {
    axes.emplace_back(Eigen::Vector3d::Unit(i));
    axes.emplace_back(-Eigen::Vector3d::Unit(i));
  }
  const ClusterWeights clusters(axes);
  EXPECT_EQ(clusters.Weights(All(axes)), std::vector<double>(6, 1.0));
  EXPECT_DOUBLE_EQ(clusters.EffectiveCount(All(axes)), 6.0);
}

TEST(ClusterWeights, BearingsOfOnePlaceWeighAsKishsDesignEffectSays) {
  const Bearings cluster(41, Eigen::Vector3d(0.6, 0.0, 0.8));
  const ClusterWeights clusters(cluster);
  EXPECT_DOUBLE_EQ(clusters.EffectiveCount(All(cluster)), 41 / (1 + 0.1 * 40));
  // Those that are not active do not count.
  std::vector<uint8_t> active(41, 0);
  active[3] = active[7] = 1;
  EXPECT_DOUBLE_EQ(clusters.Weights(active)[3], 1 / 1.1);
  EXPECT_DOUBLE_EQ(clusters.EffectiveCount(active), 2 / 1.1);
}

TEST(ClusterWeights, AnObjectOfManyCornersDoesNotOutweighTheSurroundings) {
  RandomGeometry random(1);
  Bearings surroundings;
  for (int i = 0; i < 100; ++i) surroundings.push_back(random.Bearing());
  // 300 corners within 10 degrees, on the border of cells.
  Bearings object;
  for (int i = 0; i < 300; ++i) {
    object.push_back(random.Rotation(0.17) * Eigen::Vector3d(-1, 0, 0));
  }
  EXPECT_GT(ClusterWeights(surroundings).EffectiveCount(All(surroundings)), 95);
  EXPECT_LT(ClusterWeights(object).EffectiveCount(All(object)), 60);
}

TEST(ClusterWeights, TakesPolesAndSeamAndNothing) {
  const Bearings edges = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {-1, -0.0, 0}, {1, 0, 0}};
  EXPECT_GT(ClusterWeights(edges).EffectiveCount(All(edges)), 4.5);
  EXPECT_EQ(ClusterWeights({}).EffectiveCount({}), 0);
}

}  // namespace
}  // namespace orb360
