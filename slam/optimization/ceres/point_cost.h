#pragma once

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

#include "slam/optimization/ceres/rotation_jacobian.h"
#include "slam/optimization/point_residual.h"

namespace orb360 {

/// A residual of point_residual.h as a cost function of Ceres. Its parameter blocks are the pose
/// (rotation camera_from_world as a quaternion x y z w, the camera's centre in the world) and the
/// point (world). If the pose held the translation of camera_from_world in the place of the centre,
/// a rotation would come with a translation by the angle times the distance from the origin.
/// Evaluate returns false where the residual is not finite.
template <typename Residual>
class PointCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  explicit PointCost(const Residual& residual) : residual_(residual) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> centre(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
    const Eigen::Vector3d from_centre = point - centre;
    const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
    PointJacobian by_camera_point;
    Eigen::Map<Eigen::Vector2d> values(residuals);
    values = residual_(matrix * from_centre, jacobians != nullptr ? &by_camera_point : nullptr);
    if (!values.allFinite()) return false;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
      jacobian.leftCols<4>() = by_camera_point * RotatedPointJacobian(rotation, from_centre);
      jacobian.rightCols<3>() = -by_camera_point * matrix;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} =
          by_camera_point * matrix;
    }
    return true;
  }

 private:
  Residual residual_;
};

}  // namespace orb360
