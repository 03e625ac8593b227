#include "slam/io/octree/octree_normal.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(OctahedralNormal, KeepsDirectionsWithinOneDegree) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3f direction =
        Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Vector3f read = NormalFromOctahedral(OctahedralNormal(direction));
    ASSERT_NEAR(read.norm(), 1.0f, 1e-5f);
    ASSERT_GT(read.dot(direction), std::cos(std::numbers::pi_v<float> / 180)) << direction;
  }
}

TEST(OctahedralNormal, KeepsTheAxesExactly) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      const Eigen::Vector3f direction = sign * Eigen::Vector3f::Unit(axis);
      EXPECT_LT((NormalFromOctahedral(OctahedralNormal(direction)) - direction).norm(), 1e-6f);
    }
  }
}

TEST(OctahedralNormal, OfNoDirectionIsZero) {
  EXPECT_EQ(OctahedralNormal(Eigen::Vector3f::Zero()), 0);
  EXPECT_EQ(OctahedralNormal(Eigen::Vector3f::Constant(NAN)), 0);
  EXPECT_EQ(NormalFromOctahedral(0), Eigen::Vector3f::Zero());
}

}  // namespace
}  // namespace orb360
