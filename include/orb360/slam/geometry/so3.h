#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace orb360 {

/// Returns the matrix with Skew(a) * b == a.cross(b).
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// Returns the rotation by |omega| radians about omega, exact to rounding for any angle, zero
/// included.
inline Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& omega) {
  const double squared = omega.squaredNorm();
  if (squared < 1e-16) {  // sin(x/2)/x = 1/2 to double precision below x = 1e-8
    return Eigen::Quaterniond(1.0, 0.5 * omega.x(), 0.5 * omega.y(), 0.5 * omega.z()).normalized();
  }
  const double angle = std::sqrt(squared);
  const double s = std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), s * omega.x(), s * omega.y(), s * omega.z());
}

/// Returns the rotation vector of a unit quaternion, radians: the inverse of ExpSo3. Its length,
/// the angle, is in [0, pi].
inline Eigen::Vector3d LogSo3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * sign * q.vec();
  return (2.0 * sign * std::atan2(sine, std::abs(q.w())) / sine) * q.vec();
}

}  // namespace orb360
