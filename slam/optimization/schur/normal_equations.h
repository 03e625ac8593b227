#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/optimization/schur/padded_block.h"
#include "slam/optimization/schur/residual_blocks.h"

namespace orb360 {

inline constexpr int kPoseSize = 6;  // unknowns of a pose
using PoseBlock = PaddedBlock<kPoseSize>;
using PosePointBlock = PaddedBlock<3>;

/// The pairs of a pose that is not fixed and a point with residual blocks in common, grouped by
/// point. Each pair has one off-diagonal block in the Hessian. Poses are numbered without the fixed
/// ones.
struct PosePointPairs {
  std::vector<int> pose;            ///< By pair; they increase within a point.
  std::vector<size_t> first = {0};  ///< Pair by point, and the end.

  size_t num_points() const { return first.size() - 1; }
};

/// Two poses that are not fixed with residual blocks in common that depend on no point. The first
/// one has the larger index.
using PosePair = std::array<int, 2>;

/// The normal equations of a bundle: the gradient J^T r and the Gauss-Newton approximation J^T J of
/// the Hessian, whose blocks are called U (poses), V (points) and W (pairs) as in Triggs,
/// McLauchlan, Hartley, Fitzgibbon, Bundle Adjustment: A Modern Synthesis, 2000.
struct NormalEquations {
  std::vector<PoseBlock> pose_hessian;  ///< U
  std::vector<PaddedVector> pose_gradient;
  std::vector<Eigen::Matrix3d> point_hessian;  ///< V
  std::vector<Eigen::Vector3d> point_gradient;
  std::vector<PosePointBlock> pair_hessian;  ///< W
  std::vector<PoseBlock> pose_pair_hessian;  ///< U below the diagonal, by pair of poses.

  void SetZero(size_t num_poses, const PosePointPairs& pairs, size_t num_pose_pairs = 0);

  /// Adds `weights.size()` residual blocks from `begin` on, given their rows as
  /// EvaluateResidualBlocks writes them. A block counts `weights` times.
  void Accumulate(const PosePointPairs& pairs, const ResidualBlocks& blocks, size_t begin,
                  std::span<const JacobianRow> rows, std::span<const double> weights);
};

}  // namespace orb360
