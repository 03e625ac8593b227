#pragma once

#include <cmath>

#include <Eigen/Core>

#include "slam/optimization/bearing_residual.h"

namespace orb360 {

// Residuals of a point in a camera's frame, in standard deviations, with their Jacobians by the
// point. All have two rows, the second of which may be zero, since Ceres eliminates points with
// code for blocks of 2 x 3 and 2 x 6 when no residual has another size.
using PointJacobian = Eigen::Matrix<double, 2, 3>;

/// The point is seen in a direction. See BearingResidual.
struct DirectionResidual {
  Eigen::Matrix<double, 3, 2> scaled_basis;

  /// `sigma`: angular noise of the observed unit `bearing`, rad.
  DirectionResidual(const Eigen::Vector3d& bearing, double sigma)
      : scaled_basis(TangentBasis(bearing) / sigma) {}

  Eigen::Vector2d operator()(const Eigen::Vector3d& point, PointJacobian* jacobian) const {
    return BearingResidual(point, scaled_basis, jacobian);
  }
};

/// The point lies on the ground, the camera's height below it: (-normal . p / height - 1) / sigma.
struct HeightResidual {
  Eigen::Vector3d direction;
  double offset;

  /// `normal`: of the ground, unit, towards the camera, in its frame; `height` in the world's unit;
  /// `sigma`: standard deviation as a fraction of the height.
  HeightResidual(const Eigen::Vector3d& normal, double height, double sigma)
      : direction(-normal / (height * sigma)), offset(1 / sigma) {}

  Eigen::Vector2d operator()(const Eigen::Vector3d& point, PointJacobian* jacobian) const {
    if (jacobian != nullptr) *jacobian << direction.transpose(), Eigen::RowVector3d::Zero();
    return {direction.dot(point) - offset, 0};
  }
};

/// The range of the point is known roughly: ln(|p| / range) / sigma. Not finite at |p| = 0.
struct RangeResidual {
  double log_range;
  double weight;

  /// `known` in the world's unit; `sigma`: standard deviation of its logarithm.
  RangeResidual(double known, double sigma) : log_range(std::log(known)), weight(1 / sigma) {}

  Eigen::Vector2d operator()(const Eigen::Vector3d& point, PointJacobian* jacobian) const {
    const double squared = point.squaredNorm();
    if (jacobian != nullptr) {
      *jacobian << weight / squared * point.transpose(), Eigen::RowVector3d::Zero();
    }
    return {weight * (0.5 * std::log(squared) - log_range), 0};
  }
};

}  // namespace orb360
