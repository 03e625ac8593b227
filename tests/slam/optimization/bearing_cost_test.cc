#include "slam/optimization/bearing_cost.h"

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

TEST(BearingResidual, IsTheSineOfTheAngleInStandardDeviations) {
  RandomGeometry random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d bearing = random.Bearing();
    const Eigen::Vector3d point = random.Point(0.5, 10.0);
    const double sigma = random.Uniform(0.001, 0.1);
    const Eigen::Vector2d residual = BearingResidual(point, TangentBasis(bearing) / sigma, nullptr);
    EXPECT_NEAR(residual.norm(), std::sin(AngleBetween(point, bearing)) / sigma, 1e-9 / sigma);
  }
}

TEST(BearingCost, JacobiansAreThoseOfFiniteDifferencesOverTheWholeSphere) {
  RandomGeometry random(2);
  for (int trial = 0; trial < 300; ++trial) {
    // Poles and seam among the first.
    const Eigen::Vector3d special[] = {Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ(),
                                       Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
    const Eigen::Vector3d bearing = trial < 4 ? special[trial] : random.Bearing();
    const BearingCost cost(bearing, 0.5);
    const Rigid3 pose = random.Transform();
    std::vector<double> parameters(10);
    Eigen::Map<Eigen::Quaterniond>(parameters.data()) = pose.rotation;
    Eigen::Map<Eigen::Vector3d>(parameters.data() + 4) = pose.translation;
    // Seen near its bearing.
    const Eigen::Vector3d seen = random.Uniform(1.0, 5.0) * random.Noisy(bearing, 0.3);
    Eigen::Map<Eigen::Vector3d>(parameters.data() + 7) = pose.Inverse() * seen;

    const auto evaluate = [&](const std::vector<double>& p, double* jacobian_pose,
                              double* jacobian_point) {
      const double* blocks[] = {p.data(), p.data() + 7};
      double* jacobians[] = {jacobian_pose, jacobian_point};
      Eigen::Vector2d residual;
      EXPECT_TRUE(
          cost.Evaluate(blocks, residual.data(), jacobian_pose != nullptr ? jacobians : nullptr));
      return residual;
    };
    Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    evaluate(parameters, by_pose.data(), by_point.data());
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 10; ++i) {
      std::vector<double> plus = parameters;
      std::vector<double> minus = parameters;
      plus[i] += kStep;
      minus[i] -= kStep;
      const Eigen::Vector2d numeric =
          (evaluate(plus, nullptr, nullptr) - evaluate(minus, nullptr, nullptr)) / (2 * kStep);
      const Eigen::Vector2d analytic =
          i < 7 ? Eigen::Vector2d(by_pose.col(i)) : Eigen::Vector2d(by_point.col(i - 7));
      EXPECT_LT((numeric - analytic).norm(), 1e-7 * (1 + analytic.norm())) << i;
    }
  }
}

}  // namespace
}  // namespace orb360
