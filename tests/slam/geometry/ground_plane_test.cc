#include "slam/geometry/ground_plane.h"

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

// `ground` points 1.7 below the camera and `others` above them, all within 6.
std::vector<Eigen::Vector3d> Scene(int ground, int others, double noise, RandomGeometry* random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < ground; ++i) {
    points.emplace_back(random->Uniform(-6, 6), random->Uniform(-6, 6),
                        -1.7 + random->Normal(noise));
  }
  for (int i = 0; i < others; ++i) {
    points.emplace_back(random->Uniform(-6, 6), random->Uniform(-6, 6), random->Uniform(-1.6, 3));
  }
  return points;
}

TEST(GroundPlane, IsExactWithoutNoise) {
  RandomGeometry random(1);
  const auto ground = FitGroundPlane(Scene(50, 40, 0.0, &random), kUp, {});
  ASSERT_TRUE(ground.has_value());
  EXPECT_NEAR(ground->height, 1.7, 1e-9);
  EXPECT_LT(AngleBetween(ground->normal, kUp), 1e-9);
}

TEST(GroundPlane, IsFoundOnASlopeAmongAsManyOtherPoints) {
  for (int seed = 1; seed <= 20; ++seed) {
    RandomGeometry random(seed);
    std::vector<Eigen::Vector3d> points = Scene(120, 120, 0.02, &random);
    const Eigen::Quaterniond tilt = ExpSo3({0.1, -0.12, 0.5});
    for (Eigen::Vector3d& p : points) p = tilt * p;
    const auto ground = FitGroundPlane(points, kUp, {});
    ASSERT_TRUE(ground.has_value()) << seed;
    EXPECT_NEAR(ground->height, 1.7, 0.017) << seed;
    EXPECT_LT(AngleBetween(ground->normal, tilt * kUp), 0.01) << seed;
    for (const int i : ground->points) {
      EXPECT_LT(std::abs(ground->normal.dot(points[i]) + ground->height), 0.05 * ground->height);
    }
  }
}

// A third of what lies below the camera is on the ground.
TEST(GroundPlane, IsFoundAmongManyMoreOtherPoints) {
  for (int seed = 1; seed <= 40; ++seed) {
    RandomGeometry random(seed);
    const auto ground = FitGroundPlane(Scene(100, 1500, 0.01, &random), kUp, {});
    ASSERT_TRUE(ground.has_value()) << seed;
    EXPECT_NEAR(ground->height, 1.7, 0.03) << seed;
    EXPECT_LT(AngleBetween(ground->normal, kUp), 0.015) << seed;
  }
}

// A kerb and its foot, tyres, a low wall: there is something on a road, and nothing under it.
TEST(GroundPlane, IsNotLiftedByWhatStandsOnIt) {
  for (int seed = 1; seed <= 20; ++seed) {
    RandomGeometry random(seed);
    std::vector<Eigen::Vector3d> points = Scene(200, 0, 0.004, &random);
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(random.Uniform(-6, 6), random.Uniform(-6, 6),
                          -1.7 + random.Uniform(0.0, 0.15));
    }
    const auto ground = FitGroundPlane(points, kUp, {});
    ASSERT_TRUE(ground.has_value()) << seed;
    EXPECT_NEAR(ground->height, 1.7, 0.002) << seed;
    ASSERT_EQ(ground->weights.size(), ground->points.size());
    double sum = 0;
    double weighted = 0;
    for (size_t i = 0; i < ground->points.size(); ++i) {
      sum += ground->weights[i];
      weighted -= ground->weights[i] * ground->normal.dot(points[ground->points[i]]);
    }
    EXPECT_NEAR(weighted / sum, ground->height, 1e-4) << seed;
  }
}

TEST(GroundPlane, IsNoSteepWallAndNoCeiling) {
  RandomGeometry random(3);
  std::vector<Eigen::Vector3d> points = Scene(100, 0, 0.0, &random);
  const Eigen::Quaterniond too_steep = ExpSo3({0.5, 0.0, 0.0});
  for (Eigen::Vector3d& p : points) p = too_steep * p;
  EXPECT_FALSE(FitGroundPlane(points, kUp, {}).has_value());
  std::vector<Eigen::Vector3d> ceiling = Scene(100, 0, 0.0, &random);
  for (Eigen::Vector3d& p : ceiling) p.z() = -p.z();
  EXPECT_FALSE(FitGroundPlane(ceiling, kUp, {}).has_value());
}

TEST(GroundPlane, IsNotInventedInAHeapOfPoints) {
  RandomGeometry random(4);
  EXPECT_FALSE(FitGroundPlane(Scene(0, 300, 0.0, &random), kUp, {}).has_value());
  EXPECT_FALSE(FitGroundPlane(Scene(10, 0, 0.0, &random), kUp, {}).has_value());
  EXPECT_FALSE(FitGroundPlane({}, kUp, {}).has_value());
}

TEST(GroundPlane, DoesNotMindPointsInOnePlace) {
  EXPECT_FALSE(FitGroundPlane(std::vector<Eigen::Vector3d>(50, {0.0, 0.0, -1.0}), kUp, {}));
}

}  // namespace
}  // namespace orb360
