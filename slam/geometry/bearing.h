#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace orb360 {

/// Returns the angle in radians, in [0, pi], between two directions of any non-zero length. It is
/// also accurate for small angles, where the arc cosine of the dot product loses half of its
/// digits.
inline double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns two orthonormal columns perpendicular to a unit vector. With the vector as third axis
/// they form a right-handed frame. The basis is smooth except on the circle z = 0 (Duff et al.,
/// Building an Orthonormal Basis, Revisited, JCGT 2017).
inline Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& bearing) {
  const double sign = std::copysign(1.0, bearing.z());
  const double a = -1.0 / (sign + bearing.z());
  const double b = bearing.x() * bearing.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis << 1.0 + sign * bearing.x() * bearing.x() * a, b,  //
      sign * b, sign + bearing.y() * bearing.y() * a,      //
      -sign * bearing.x(), -bearing.y();
  return basis;
}

}  // namespace orb360
