#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/rigid3.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {

/// Parameters of a cost of a pose and a point, one behind the other.
inline std::vector<double> CostParameters(const Rigid3& camera_from_world,
                                          const Eigen::Vector3d& point) {
  std::vector<double> parameters(10);
  Eigen::Map<Eigen::Quaterniond>(parameters.data()) = camera_from_world.rotation;
  Eigen::Map<Eigen::Vector3d>(parameters.data() + 4) = camera_from_world.translation;
  Eigen::Map<Eigen::Vector3d>(parameters.data() + 7) = point;
  return parameters;
}

/// Of a cost with one residual and one that is always zero.
template <typename Cost>
double Residual(const Cost& cost, const std::vector<double>& parameters) {
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  Eigen::Vector2d residuals(7, 7);
  EXPECT_TRUE(cost.Evaluate(blocks, residuals.data(), nullptr));
  EXPECT_EQ(residuals[1], 0);
  return residuals[0];
}

/// Compares the derivatives of such a cost with finite differences.
template <typename Cost>
void ExpectDerivatives(const Cost& cost, const std::vector<double>& parameters) {
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  by_pose.setConstant(7);
  by_point.setConstant(7);
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  double* jacobians[] = {by_pose.data(), by_point.data()};
  Eigen::Vector2d residuals;
  ASSERT_TRUE(cost.Evaluate(blocks, residuals.data(), jacobians));
  EXPECT_TRUE(by_pose.row(1).isZero(0) && by_point.row(1).isZero(0));
  for (int i = 0; i < 10; ++i) {
    constexpr double kStep = 1e-6;
    std::vector<double> plus = parameters;
    std::vector<double> minus = parameters;
    plus[i] += kStep;
    minus[i] -= kStep;
    const double numeric = (Residual(cost, plus) - Residual(cost, minus)) / (2 * kStep);
    const double analytic = i < 7 ? by_pose(0, i) : by_point(0, i - 7);
    EXPECT_NEAR(numeric, analytic, 1e-7 * (1 + std::abs(analytic))) << i;
  }
}

}  // namespace orb360
