#include "slam/optimization/height_cost.h"

#include <gtest/gtest.h>

#include "tests/slam/optimization/cost_check.h"

namespace orb360 {
namespace {

TEST(HeightCost, IsTheErrorOfTheHeightInStandardDeviations) {
  RandomGeometry random(1);
  const Rigid3 camera_from_world = random.Transform();
  const Eigen::Vector3d normal = random.Bearing();
  const HeightCost cost(normal, 1.5, 0.02);
  const Eigen::Vector3d aside = normal.cross(random.Bearing());
  for (const double height : {1.5, 1.53, 1.2}) {
    const Eigen::Vector3d seen = 3 * aside - height * normal;
    const double residual =
        Residual(cost, CostParameters(camera_from_world, camera_from_world.Inverse() * seen));
    EXPECT_NEAR(residual, (height / 1.5 - 1) / 0.02, 1e-9);
  }
}

TEST(HeightCost, JacobiansAreThoseOfFiniteDifferences) {
  RandomGeometry random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const HeightCost cost(random.Bearing(), random.Uniform(0.5, 3.0), 0.1);
    ExpectDerivatives(cost, CostParameters(random.Transform(), random.Point(1.0, 5.0)));
  }
}

}  // namespace
}  // namespace orb360
