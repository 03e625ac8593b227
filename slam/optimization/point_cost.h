#pragma once

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

#include "slam/optimization/point_residual.h"
#include "slam/optimization/rotation_jacobian.h"

namespace orb360 {

/// A residual of point_residual.h for Ceres. Parameters: pose as camera_from_world (quaternion
/// x y z w, translation), point (world). False where the residual is not finite.
template <typename Residual>
class PointCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  explicit PointCost(const Residual& residual) : residual_(residual) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
    const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
    PointJacobian by_seen;
    Eigen::Map<Eigen::Vector2d> values(residuals);
    values = residual_(matrix * point + translation, jacobians != nullptr ? &by_seen : nullptr);
    if (!values.allFinite()) return false;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
      jacobian.leftCols<4>() = by_seen * RotatedPointJacobian(rotation, point);
      jacobian.rightCols<3>() = by_seen;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} = by_seen * matrix;
    }
    return true;
  }

 private:
  Residual residual_;
};

}  // namespace orb360
