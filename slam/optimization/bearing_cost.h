#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/optimization/bearing_residual.h"

namespace orb360 {

/// BearingResidual of a point in the world seen from a pose, for Ceres. Parameters: pose as
/// camera_from_world (quaternion x y z w, translation), point (world).
class BearingCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  /// `sigma`: angular noise of the observed unit `bearing`, rad.
  BearingCost(const Eigen::Vector3d& bearing, double sigma)
      : scaled_basis_(TangentBasis(bearing) / sigma) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Matrix<double, 3, 2> scaled_basis_;
};

}  // namespace orb360
