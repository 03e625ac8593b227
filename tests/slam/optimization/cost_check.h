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

template <typename Cost>
double Residual(const Cost& cost, const std::vector<double>& parameters) {
  const double* blocks[] = {parameters.data(), parameters.data() + 7};
  double residual = 0;
  EXPECT_TRUE(cost.Evaluate(blocks, &residual, nullptr));
  return residual;
}

/// Compares the derivatives of a cost with one residual with finite differences.
template <typename Cost>
void ExpectDerivatives(const Cost& cost, const std::vector<double>& parameters) {
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

}  // namespace orb360
