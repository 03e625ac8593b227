#include "slam/optimization/bearing_cost.h"

#include <Eigen/Geometry>

#include "slam/geometry/so3.h"

namespace orb360 {
namespace {

// d (q * x) / d q for q * x = x + 2 w (v x x) + 2 v x (v x x), q = (v, w), columns x y z w.
Eigen::Matrix<double, 3, 4> RotatedPointJacobian(const Eigen::Quaterniond& q,
                                                 const Eigen::Vector3d& x) {
  const Eigen::Vector3d v = q.vec();
  Eigen::Matrix<double, 3, 4> jacobian;
  // v x (v x x) = v (v.x) - x (v.v).
  jacobian.leftCols<3>() = -2.0 * q.w() * Skew(x) + 2.0 * v.dot(x) * Eigen::Matrix3d::Identity() +
                           2.0 * v * x.transpose() - 4.0 * x * v.transpose();
  jacobian.col(3) = 2.0 * v.cross(x);
  return jacobian;
}

}  // namespace

bool BearingCost::Evaluate(const double* const* parameters, double* residuals,
                           double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
  const Eigen::Vector3d point_camera = matrix * point + translation;
  Eigen::Matrix<double, 2, 3> point_jacobian;
  Eigen::Map<Eigen::Vector2d>{residuals} = BearingResidual(
      point_camera, scaled_basis_, jacobians != nullptr ? &point_jacobian : nullptr);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.leftCols<4>() = point_jacobian * RotatedPointJacobian(rotation, point);
    jacobian.rightCols<3>() = point_jacobian;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} =
        point_jacobian * matrix;
  }
  return true;
}

}  // namespace orb360
