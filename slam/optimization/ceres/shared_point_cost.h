#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/sized_cost_function.h>

#include "slam/optimization/bundle_problem.h"
#include "slam/optimization/ceres/rotation_jacobian.h"

namespace orb360 {

/// A point that two cameras see (BundleProblem::SharedPoint) as a cost function of Ceres. Its
/// parameter blocks are two poses, as PointCost has them.
class SharedPointCost final : public ceres::SizedCostFunction<2, 7, 7> {
 public:
  explicit SharedPointCost(const BundleProblem::SharedPoint& shared) : shared_point_(shared) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation1(parameters[0]);
    const Eigen::Map<const Eigen::Quaterniond> rotation2(parameters[1]);
    const Eigen::Map<const Eigen::Vector3d> centre1(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> centre2(parameters[1] + 4);
    const Eigen::Matrix<double, 2, 3>& weight = shared_point_.sqrt_information;
    const Eigen::Vector3d from_centre2 =
        rotation1.conjugate() * shared_point_.point1 + centre1 - centre2;
    const Eigen::Matrix<double, 2, 3> by_world = weight * rotation2.toRotationMatrix();
    Eigen::Map<Eigen::Vector2d> values(residuals);
    values = by_world * from_centre2 - weight * shared_point_.point2;
    if (jacobians == nullptr) return true;
    using Jacobian = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
    if (jacobians[0] != nullptr) {
      Jacobian jacobian(jacobians[0]);
      jacobian.leftCols<4>() =
          by_world * RotatedPointJacobian(rotation1.conjugate(), shared_point_.point1);
      jacobian.leftCols<3>() *= -1;  // of the conjugate
      jacobian.rightCols<3>() = by_world;
    }
    if (jacobians[1] != nullptr) {
      Jacobian jacobian(jacobians[1]);
      jacobian.leftCols<4>() = weight * RotatedPointJacobian(rotation2, from_centre2);
      jacobian.rightCols<3>() = -by_world;
    }
    return true;
  }

 private:
  BundleProblem::SharedPoint shared_point_;
};

}  // namespace orb360
