#pragma once

#include <Eigen/Geometry>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {

/// d (q * x) / d q for q * x = x + 2 w (v x x) + 2 v x (v x x), q = (v, w), columns x y z w: the
/// order in which Eigen stores a quaternion.
inline Eigen::Matrix<double, 3, 4> RotatedPointJacobian(const Eigen::Quaterniond& q,
                                                        const Eigen::Vector3d& x) {
  const Eigen::Vector3d v = q.vec();
  Eigen::Matrix<double, 3, 4> jacobian;
  // v x (v x x) = v (v.x) - x (v.v).
  jacobian.leftCols<3>() = -2.0 * q.w() * Skew(x) + 2.0 * v.dot(x) * Eigen::Matrix3d::Identity() +
                           2.0 * v * x.transpose() - 4.0 * x * v.transpose();
  jacobian.col(3) = 2.0 * v.cross(x);
  return jacobian;
}

}  // namespace orb360
