#pragma once

#include <cmath>

#include <Eigen/Core>

namespace orb360 {

/// Two orthonormal directions (columns) of the tangent plane at a unit vector; any choice serves.
inline Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& bearing) {
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017: no branch but the sign.
  const double sign = std::copysign(1.0, bearing.z());
  const double a = -1.0 / (sign + bearing.z());
  const double b = bearing.x() * bearing.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) << 1.0 + sign * bearing.x() * bearing.x() * a, sign * b, -sign * bearing.x();
  basis.col(1) << b, sign + bearing.y() * bearing.y() * a, -bearing.y();
  return basis;
}

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
  const Eigen::Vector2d residual = scaled_basis.transpose() * unit;
  if (jacobian != nullptr) {
    *jacobian = inverse_range * (scaled_basis.transpose() - residual * unit.transpose());
  }
  return residual;
}

/// Squared residuals of a correct match follow a chi-squared law of 2 degrees of freedom: 95 %
/// are below this.
inline constexpr double kChiSquared95 = 5.991;

}  // namespace orb360
