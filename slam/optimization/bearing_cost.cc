#include "slam/optimization/bearing_cost.h"

#include "slam/optimization/rotation_jacobian.h"

namespace orb360 {
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
