#include "slam/optimization/range_cost.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/slam/optimization/cost_check.h"

namespace orb360 {
namespace {

TEST(RangeCost, IsTheErrorOfTheLogarithmInStandardDeviations) {
  RandomGeometry random(3);
  const Rigid3 camera_from_world = random.Transform();
  const RangeCost cost(4.0, 0.1);
  for (const double range : {4.0, 4.4, 2.0}) {
    const Eigen::Vector3d point = camera_from_world.Inverse() * (range * random.Bearing());
    EXPECT_NEAR(Residual(cost, CostParameters(camera_from_world, point)), std::log(range / 4) / 0.1,
                1e-9);
  }
}

TEST(RangeCost, JacobiansAreThoseOfFiniteDifferences) {
  RandomGeometry random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const RangeCost cost(random.Uniform(0.5, 30.0), 0.2);
    const Rigid3 camera_from_world = random.Transform();
    const Eigen::Vector3d seen = random.Point(1.0, 5.0);
    ExpectDerivatives(cost, CostParameters(camera_from_world, camera_from_world.Inverse() * seen));
  }
}

TEST(RangeCost, HasNoValueAtTheCentreOfTheCamera) {
  const RangeCost cost(1.0, 0.1);
  const std::vector<double> parameters = CostParameters(Rigid3(), Eigen::Vector3d::Zero());
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  Eigen::Vector2d residuals;
  EXPECT_FALSE(cost.Evaluate(blocks, residuals.data(), nullptr));
}

}  // namespace
}  // namespace orb360
