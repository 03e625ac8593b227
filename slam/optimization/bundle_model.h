#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <ceres/loss_function.h>

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/bundle_loss.h"
#include "slam/optimization/bundle_terms.h"
#include "slam/optimization/normal_equations.h"

namespace orb360 {

/// What is estimated. A step turns each camera's frame by exp(w) where the camera stands, and then
/// moves it: how far it gets does not depend on where the world's origin is.
struct BundleEstimate {
  std::vector<Rigid3> camera_from_world;
  std::vector<Eigen::Vector3d> points;
};

/// How an estimate changes.
struct BundleStep {
  std::vector<PoseVector> poses;  // turn and shift of those that move
  std::vector<Eigen::Vector3d> points;
  double predicted = 0;  // decrease of the cost, were everything linear
};

/// The cost of a problem as a function of what is estimated.
class BundleModel {
 public:
  BundleModel(const BundleOptions& options, const BundleProblem& problem);

  /// Infinite where a residual is not finite.
  double Cost(const BundleEstimate& estimate) const;
  /// The same, and the normal equations there; they mean nothing where it is infinite.
  double Linearize(const BundleEstimate& estimate, NormalEquations* equations) const;
  BundleEstimate Moved(const BundleEstimate& estimate, const BundleStep& step) const;

  const BundleLinks& links() const { return links_; }
  const ReducedStructure& structure() const { return structure_; }

 private:
  double Evaluate(const BundleEstimate& estimate, NormalEquations* equations) const;
  const ceres::LossFunction* LossOf(BundleTerms::Kind kind) const;

  std::array<BundleTerms, 3> terms_;
  BundleLinks links_;
  ReducedStructure structure_;
  std::vector<int> moving_;  // by pose: its place among those that move, or -1
  int num_moving_ = 0;
  std::unique_ptr<ceres::LossFunction> direction_loss_;
  ceres::CauchyLoss range_loss_{kRangeCauchySigmas};
};

}  // namespace orb360
