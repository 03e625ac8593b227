#include "slam/optimization/height_cost.h"

#include "slam/optimization/rotation_jacobian.h"

namespace orb360 {

bool HeightCost::Evaluate(const double* const* parameters, double* residuals,
                          double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  residuals[0] = direction_.dot(rotation * point + translation) - offset_;
  residuals[1] = 0;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.row(1).setZero();
    jacobian.topLeftCorner<1, 4>() = direction_.transpose() * RotatedPointJacobian(rotation, point);
    jacobian.topRightCorner<1, 3>() = direction_.transpose();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> jacobian(jacobians[1]);
    jacobian.row(1).setZero();
    jacobian.row(0) = direction_.transpose() * rotation.toRotationMatrix();
  }
  return true;
}

}  // namespace orb360
