#pragma once

#include <ceres/sized_cost_function.h>

namespace orb360 {

/// A point's range from a camera against one that is known roughly: ln(|p| / range) / sigma with p
/// in the camera. Parameters as for BearingCost: pose as camera_from_world (quaternion x y z w,
/// translation), point (world). The second residual is always zero, as that of HeightCost.
class RangeCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  /// `range` in the world's unit; `sigma`: standard deviation of its logarithm.
  RangeCost(double range, double sigma) : range_(range), weight_(1 / sigma) {}

  /// False for a point at the camera's centre.
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double range_;
  double weight_;
};

}  // namespace orb360
