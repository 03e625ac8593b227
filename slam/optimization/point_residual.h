#pragma once

#include <cmath>

#include <Eigen/Core>

#include "slam/optimization/bearing_residual.h"

namespace orb360 {

// What is known of a point in a camera's frame, as two residuals in standard deviations, with their
// derivatives by the point. All have two rows, if need be with zeros in the second: where they
// have, Ceres eliminates points with code for blocks of 2 x 3 and 2 x 6, instead of sizes found at
// run time.
using PointJacobian = Eigen::Matrix<double, 2, 3>;

/// Its direction, see BearingResidual.
struct DirectionResidual {
  Eigen::Matrix<double, 3, 2> scaled_basis;

  /// `sigma`: angular noise of the observed unit `bearing`, rad.
  DirectionResidual(const Eigen::Vector3d& bearing, double sigma)
      : scaled_basis(TangentBasis(bearing) / sigma) {}

  Eigen::Vector2d operator()(const Eigen::Vector3d& point, PointJacobian* jacobian) const {
    return BearingResidual(point, scaled_basis, jacobian);
  }
};

/// A point of the ground lies the camera's height below it: (-normal . p / height - 1) / sigma.
struct HeightResidual {
  Eigen::Vector3d direction;
  double offset;

  /// `normal`: of the ground, unit, towards the camera, in its frame; `height` in the world's unit;
  /// `sigma`: standard deviation as a share of the height.
  HeightResidual(const Eigen::Vector3d& normal, double height, double sigma)
      : direction(-normal / (height * sigma)), offset(1 / sigma) {}

  Eigen::Vector2d operator()(const Eigen::Vector3d& point, PointJacobian* jacobian) const {
    if (jacobian != nullptr) *jacobian << direction.transpose(), Eigen::RowVector3d::Zero();
    return {direction.dot(point) - offset, 0};
  }
};

/// Its range is known roughly: ln(|p| / range) / sigma. Not finite for a point at the centre.
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
