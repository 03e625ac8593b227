#include "slam/optimization/ceres/point_cost.h"

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

/// Compares the derivatives of a residual, as Ceres gets them, with finite differences.
template <typename Residual>
void ExpectDerivatives(const Residual& residual, const Rigid3& camera_from_world,
                       const Eigen::Vector3d& seen) {
  const PointCost<Residual> cost(residual);
  Eigen::Matrix<double, 10, 1> parameters;
  const Rigid3 world_from_camera = camera_from_world.Inverse();
  parameters << camera_from_world.rotation.coeffs(), world_from_camera.translation,
      world_from_camera * seen;
  const auto evaluate = [&cost](const Eigen::Matrix<double, 10, 1>& p, double** jacobians) {
    const double* blocks[] = {p.data(), p.data() + 7};
    Eigen::Vector2d values;
    EXPECT_TRUE(cost.Evaluate(blocks, values.data(), jacobians));
    return values;
  };
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  by_pose.setConstant(7);
  by_point.setConstant(7);
  double* jacobians[] = {by_pose.data(), by_point.data()};
  evaluate(parameters, jacobians);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Matrix<double, 10, 1> step = kStep * Eigen::Matrix<double, 10, 1>::Unit(i);
    const Eigen::Vector2d numeric =
        (evaluate(parameters + step, nullptr) - evaluate(parameters - step, nullptr)) / (2 * kStep);
    const Eigen::Vector2d analytic =
        i < 7 ? Eigen::Vector2d(by_pose.col(i)) : Eigen::Vector2d(by_point.col(i - 7));
    EXPECT_LT((numeric - analytic).norm(), 1e-7 * (1 + analytic.norm())) << i;
  }
}

TEST(PointCost, DerivativesAreThoseOfFiniteDifferencesOverTheWholeSphere) {
  RandomGeometry random(2);
  for (int trial = 0; trial < 300; ++trial) {
    // Poles and seam among the first.
    const Eigen::Vector3d special[] = {Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ(),
                                       Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
    const Eigen::Vector3d bearing = trial < 4 ? special[trial] : random.Bearing();
    const Rigid3 pose = random.Transform();
    const Eigen::Vector3d seen = random.Uniform(1.0, 5.0) * random.Noisy(bearing, 0.3);
    ExpectDerivatives(DirectionResidual(bearing, 0.5), pose, seen);
    ExpectDerivatives(HeightResidual(random.Bearing(), random.Uniform(0.5, 3.0), 0.1), pose, seen);
    ExpectDerivatives(RangeResidual(random.Uniform(0.5, 30.0), 0.2), pose, seen);
  }
}

TEST(PointCost, HasNoValueAtTheCentreOfTheCamera) {
  const PointCost<RangeResidual> cost(RangeResidual(1.0, 0.1));
  Eigen::Matrix<double, 10, 1> parameters = Eigen::Matrix<double, 10, 1>::Unit(3);
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  Eigen::Vector2d residuals;
  EXPECT_FALSE(cost.Evaluate(blocks, residuals.data(), nullptr));
}

}  // namespace
}  // namespace orb360
