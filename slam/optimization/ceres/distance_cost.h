#pragma once

#include <cmath>

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

#include "slam/optimization/point_residual.h"

namespace orb360 {

/// The distance between two cameras (BundleProblem::Distance) as a cost function of Ceres. Its
/// parameter blocks are two poses, as PointCost has them. Evaluate returns false where the cameras
/// are in one place.
class DistanceCost final : public ceres::SizedCostFunction<1, 7, 7> {
 public:
  explicit DistanceCost(const RangeResidual& residual) : residual_(residual) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector3d> centre1(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> centre2(parameters[1] + 4);
    PointJacobian by_between;
    residuals[0] = residual_(centre2 - centre1, &by_between).x();
    if (!std::isfinite(residuals[0])) return false;
    for (int pose = 0; jacobians != nullptr && pose < 2; ++pose) {
      if (jacobians[pose] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 1, 7>> jacobian(jacobians[pose]);
      jacobian.setZero();
      jacobian.tail<3>() = (pose == 0 ? -1.0 : 1.0) * by_between.row(0);
    }
    return true;
  }

 private:
  RangeResidual residual_;
};

}  // namespace orb360
