#include "slam/optimization/range_cost.h"

#include <cmath>

#include "slam/optimization/rotation_jacobian.h"

namespace orb360 {

bool RangeCost::Evaluate(const double* const* parameters, double* residuals,
                         double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  const Eigen::Vector3d seen = rotation * point + translation;
  const double squared_range = seen.squaredNorm();
  if (!(squared_range > 0)) return false;
  residuals[0] = weight_ * (0.5 * std::log(squared_range) - std::log(range_));
  residuals[1] = 0;
  if (jacobians == nullptr) return true;
  const Eigen::RowVector3d by_seen = weight_ / squared_range * seen.transpose();
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
    jacobian.row(1).setZero();
    jacobian.topLeftCorner<1, 4>() = by_seen * RotatedPointJacobian(rotation, point);
    jacobian.topRightCorner<1, 3>() = by_seen;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> jacobian(jacobians[1]);
    jacobian.row(1).setZero();
    jacobian.row(0) = by_seen * rotation.toRotationMatrix();
  }
  return true;
}

}  // namespace orb360
