#pragma once

#include <Eigen/Core>

#include "slam/geometry/bearing.h"

namespace orb360 {

/// Reprojection error on the sphere: the predicted unit bearing p/|p| seen from the tangent plane
/// at the observed one, divided by the observation's angular noise, so both components have unit
/// variance. Its length is sin(angle)/sigma, regular everywhere but at p = 0; a point opposite to
/// its observation has residual 0 as well, so callers must also check that p . bearing > 0.
/// `jacobian`, unless null, is d residual / d p.
inline Eigen::Vector2d BearingResidual(const Eigen::Vector3d& point_camera,
                                       const Eigen::Matrix<double, 3, 2>& scaled_basis,
                                       Eigen::Matrix<double, 2, 3>* jacobian) {
  const double inverse_range = 1.0 / point_camera.norm();
  const Eigen::Vector3d unit = inverse_range * point_camera;
  Eigen::Vector2d residual = scaled_basis.transpose() * unit;
  if (jacobian != nullptr) {
    *jacobian = inverse_range * (scaled_basis.transpose() - residual * unit.transpose());
  }
  return residual;
}

/// 95 % bound of the squared residual of a correct match, which has a chi-squared distribution with
/// 2 degrees of freedom.
inline constexpr double kChiSquared95 = 5.991;

}  // namespace orb360
