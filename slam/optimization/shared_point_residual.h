#pragma once

#include <Eigen/Core>

#include "slam/optimization/bundle_problem.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {

/// Derivative of a residual by the unknowns (w, d) of a pose, which change it to
/// camera_from_world' = (exp(w), d) * camera_from_world.
using SharedPointJacobian = Eigen::Matrix<double, 2, 6>;

/// The difference between where two cameras (poses: camera_from_world) see the same point, in
/// standard deviations. The Jacobians may be null.
inline Eigen::Vector2d SharedPointResidual(const BundleProblem::SharedPoint& shared,
                                           const Rigid3& pose1, const Rigid3& pose2,
                                           SharedPointJacobian* by_pose1,
                                           SharedPointJacobian* by_pose2) {
  const Eigen::Vector3d seen = pose2 * (pose1.Inverse() * shared.point1);
  const Eigen::Matrix<double, 2, 3>& weight = shared.sqrt_information;
  if (by_pose1 != nullptr) {
    const Eigen::Matrix<double, 2, 3> by_point1 =
        weight * (pose2.rotation * pose1.rotation.conjugate()).toRotationMatrix();
    *by_pose1 << by_point1 * Skew(shared.point1), -by_point1;
  }
  if (by_pose2 != nullptr) *by_pose2 << -weight * Skew(seen), weight;
  return weight * (seen - shared.point2);
}

}  // namespace orb360
