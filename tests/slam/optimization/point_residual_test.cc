#include "slam/optimization/point_residual.h"

#include <cmath>

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

TEST(DirectionResidual, IsTheSineOfTheAngleInStandardDeviations) {
  RandomGeometry random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d bearing = random.Bearing();
    const Eigen::Vector3d point = random.Point(0.5, 10.0);
    const double sigma = random.Uniform(0.001, 0.1);
    const Eigen::Vector2d residual = DirectionResidual(bearing, sigma)(point, nullptr);
    EXPECT_NEAR(residual.norm(), std::sin(AngleBetween(point, bearing)) / sigma, 1e-9 / sigma);
  }
}

TEST(HeightResidual, IsTheErrorOfTheHeightInStandardDeviations) {
  RandomGeometry random(1);
  const Eigen::Vector3d normal = random.Bearing();
  const Eigen::Vector3d aside = normal.cross(random.Bearing());
  for (const double height : {1.5, 1.53, 1.2}) {
    const Eigen::Vector2d residual =
        HeightResidual(normal, 1.5, 0.02)(3 * aside - height * normal, nullptr);
    EXPECT_NEAR(residual.x(), (height / 1.5 - 1) / 0.02, 1e-9);
    EXPECT_EQ(residual.y(), 0);
  }
}

TEST(RangeResidual, IsTheErrorOfTheLogarithmInStandardDeviations) {
  RandomGeometry random(3);
  for (const double range : {4.0, 4.4, 2.0}) {
    const Eigen::Vector2d residual = RangeResidual(4.0, 0.1)(range * random.Bearing(), nullptr);
    EXPECT_NEAR(residual.x(), std::log(range / 4) / 0.1, 1e-9);
    EXPECT_EQ(residual.y(), 0);
  }
}

}  // namespace
}  // namespace orb360
