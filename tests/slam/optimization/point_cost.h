#pragma once

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

#include "slam/optimization/point_residual.h"
#include "tests/slam/optimization/rotation_jacobian.h"

namespace orb360 {

/// A residual of point_residual.h for Ceres. Parameters: pose (rotation camera_from_world as
/// quaternion x y z w, the camera's centre in the world), point (world). With a translation of
/// camera_from_world in the place of the centre, a camera that turns would have to move by the
/// angle times its distance from the origin. False where the residual is not finite.
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
    PointJacobian by_seen;
    Eigen::Map<Eigen::Vector2d> values(residuals);
    values = residual_(matrix * from_centre, jacobians != nullptr ? &by_seen : nullptr);
    if (!values.allFinite()) return false;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> jacobian(jacobians[0]);
      jacobian.leftCols<4>() = by_seen * RotatedPointJacobian(rotation, from_centre);
      jacobian.rightCols<3>() = -by_seen * matrix;
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
