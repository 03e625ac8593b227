#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/robust_loss.h"
#include "slam/optimization/schur/normal_equations.h"
#include "slam/optimization/schur/padded_block.h"
#include "slam/optimization/schur/residual_blocks.h"

namespace orb360 {

/// The parameters of a bundle. The six unknowns (w, d) of a pose change it to
/// camera_from_world' = (exp(w), d) * camera_from_world: the camera rotates about its own centre
/// and then moves, so that the length of a step does not depend on the world's origin.
struct BundleState {
  std::vector<Rigid3> camera_from_world;
  std::vector<Eigen::Vector3d> points;
};

/// A change of a state.
struct BundleStep {
  std::vector<PaddedVector> poses;  ///< Of those that are not fixed.
  std::vector<Eigen::Vector3d> points;
};

/// Evaluates the robust cost of a problem and linearizes it.
class BundleEvaluator {
 public:
  BundleEvaluator(BundleLoss loss, const BundleProblem& problem);

  /// Infinite where a residual is not finite.
  double Cost(const BundleState& state) const;
  /// The same, and the normal equations, which are meaningless where the cost is infinite.
  double Linearize(const BundleState& state, NormalEquations* equations) const;
  BundleState Plus(const BundleState& state, const BundleStep& step) const;

  const PosePointPairs& pairs() const { return pairs_; }
  const std::vector<PosePair>& pose_pairs() const { return pose_pairs_; }
  /// Number of poses that are not fixed.
  int num_free_poses() const { return num_free_poses_; }

 private:
  double Evaluate(const BundleState& state, NormalEquations* equations) const;

  double EvaluateSharedPoints(const BundleState& state, NormalEquations* equations) const;

  std::array<ResidualBlocks, 3> blocks_;  ///< By kind.
  std::array<RobustLoss, 3> losses_;      ///< By kind.
  std::vector<BundleProblem::SharedPoint> shared_points_;
  PosePointPairs pairs_;
  std::vector<PosePair> pose_pairs_;  ///< Sorted.
  std::vector<int> free_index_;       ///< By pose: its index among those that are not fixed, or -1.
  int num_free_poses_ = 0;
};

}  // namespace orb360
