#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <ceres/loss_function.h>

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/bundle_loss.h"
#include "slam/optimization/point_residual.h"

namespace orb360 {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// What is estimated. A step turns each camera's frame by exp(w) where the camera stands, and then
/// moves it: how far it gets does not depend on where the world's origin is.
struct BundleEstimate {
  std::vector<Rigid3> camera_from_world;
  std::vector<Eigen::Vector3d> points;
};

/// What a pose that moves and a point have in common: the block of the normal equations.
struct BundleLink {
  int pose;  // among those that move
  Matrix63 block;
};

/// The normal equations of one linearization: blocks of the diagonal, those that link a pose and a
/// point, and the gradient.
struct NormalEquations {
  std::vector<Matrix6> poses;  // by pose among those that move
  std::vector<Vector6> pose_gradients;
  std::vector<Eigen::Matrix3d> points;
  std::vector<Eigen::Vector3d> point_gradients;
  std::vector<BundleLink> links;   // by point
  std::vector<size_t> first_link;  // by point, and the end
};

/// How an estimate changes.
struct BundleStep {
  std::vector<Vector6> poses;
  std::vector<Eigen::Vector3d> points;
  double predicted = 0;  // decrease of the cost, were everything linear
};

/// The cost of a problem as a function of what is estimated.
class BundleModel {
 public:
  BundleModel(const BundleOptions& options, const BundleProblem& problem);

  /// Infinite where a residual is not finite.
  double Cost(const BundleEstimate& estimate) const;
  NormalEquations Linearize(const BundleEstimate& estimate) const;
  BundleEstimate Moved(const BundleEstimate& estimate, const BundleStep& step) const;

 private:
  /// One residual of a point, by its kind and place in the problem.
  struct Term {
    enum Kind { kDirection, kHeight, kRange } kind;
    int pose;
    int index;
  };

  /// Calls take(pose, point seen from the camera, weighted residual, weighted derivative by that)
  /// for each of a point's terms, or nothing where derivatives are not wanted; returns their cost.
  template <bool kWithDerivatives, typename Take>
  double ForEachTerm(const BundleEstimate& estimate, const std::vector<Eigen::Matrix3d>& rotations,
                     size_t point, const Take& take) const;
  Eigen::Vector2d Residual(const Term& term, const Eigen::Vector3d& seen,
                           PointJacobian* jacobian) const;

  std::vector<DirectionResidual> directions_;
  std::vector<HeightResidual> heights_;
  std::vector<RangeResidual> ranges_;
  std::vector<Term> terms_;  // by point
  std::vector<size_t> first_term_;
  std::vector<int> moving_;  // by pose: its place among those that move, or -1
  int num_moving_ = 0;
  std::unique_ptr<ceres::LossFunction> direction_loss_;
  ceres::CauchyLoss range_loss_{kRangeCauchySigmas};
};

}  // namespace orb360
