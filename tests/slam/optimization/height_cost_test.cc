#include "slam/optimization/height_cost.h"

#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/rigid3.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

std::vector<double> Parameters(const Rigid3& camera_from_world, const Eigen::Vector3d& point) {
  std::vector<double> parameters(10);
  Eigen::Map<Eigen::Quaterniond>(parameters.data()) = camera_from_world.rotation;
  Eigen::Map<Eigen::Vector3d>(parameters.data() + 4) = camera_from_world.translation;
  Eigen::Map<Eigen::Vector3d>(parameters.data() + 7) = point;
  return parameters;
}

double Residual(const HeightCost& cost, const std::vector<double>& parameters) {
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  double residual = 0;
  EXPECT_TRUE(cost.Evaluate(blocks, &residual, nullptr));
  return residual;
}

TEST(HeightCost, IsTheErrorOfTheHeightInStandardDeviations) {
  RandomGeometry random(1);
  const Rigid3 camera_from_world = random.Transform();
  const Eigen::Vector3d normal = random.Bearing();
  const HeightCost cost(normal, 1.5, 0.02);
  const Eigen::Vector3d aside = normal.cross(random.Bearing());
  for (const double height : {1.5, 1.53, 1.2}) {
    const Eigen::Vector3d seen = 3 * aside - height * normal;
    const double residual =
        Residual(cost, Parameters(camera_from_world, camera_from_world.Inverse() * seen));
    EXPECT_NEAR(residual, (height / 1.5 - 1) / 0.02, 1e-9);
  }
}

TEST(HeightCost, JacobiansAreThoseOfFiniteDifferences) {
  RandomGeometry random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const HeightCost cost(random.Bearing(), random.Uniform(0.5, 3.0), 0.1);
    const std::vector<double> parameters = Parameters(random.Transform(), random.Point(1.0, 5.0));
    Eigen::Matrix<double, 1, 7> by_pose;
    Eigen::Matrix<double, 1, 3> by_point;
    const double* blocks[] = {parameters.data(), parameters.data() + 7};
    double* jacobians[] = {by_pose.data(), by_point.data()};
    double residual = 0;
    ASSERT_TRUE(cost.Evaluate(blocks, &residual, jacobians));
    for (int i = 0; i < 10; ++i) {
      constexpr double kStep = 1e-6;
      std::vector<double> plus = parameters;
      std::vector<double> minus = parameters;
      plus[i] += kStep;
      minus[i] -= kStep;
      const double numeric = (Residual(cost, plus) - Residual(cost, minus)) / (2 * kStep);
      const double analytic = i < 7 ? by_pose[i] : by_point[i - 7];
      EXPECT_NEAR(numeric, analytic, 1e-7 * (1 + std::abs(analytic))) << i;
    }
  }
}

}  // namespace
}  // namespace orb360
