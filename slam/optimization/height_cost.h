#pragma once

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

namespace orb360 {

/// A point of the ground lies the camera's height below it: (-normal . p / height - 1) / sigma with
/// p in the camera. Parameters as for BearingCost: pose as camera_from_world (quaternion x y z w,
/// translation), point (world). The second residual is always zero: where all have two rows, Ceres
/// eliminates points with code for blocks of 2 x 3 and 2 x 6, instead of sizes found at run time.
class HeightCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  /// `normal`: of the ground, unit, towards the camera, in its frame; `height` in the world's unit;
  /// `sigma`: standard deviation as a share of the height.
  HeightCost(const Eigen::Vector3d& normal, double height, double sigma)
      : direction_(-normal / (height * sigma)), offset_(1 / sigma) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d direction_;
  double offset_;
};

}  // namespace orb360
