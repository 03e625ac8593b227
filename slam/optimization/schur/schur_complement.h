#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/optimization/schur/block_structure.h"
#include "slam/optimization/schur/normal_equations.h"
#include "slam/optimization/schur/padded_block.h"

namespace orb360 {

/// Structure of the reduced camera system, which is left when the points are eliminated: two poses
/// have a block in common where they see a point in common or are a pair of poses. A point that
/// more than `max_poses` poses see is kept as a row behind those of the poses. Its elimination
/// would link each of these poses with each other, and a few clouds or towers that are seen from
/// everywhere would make the sparse matrix full.
struct ReducedCameraStructure : BlockStructure {
  static constexpr size_t kMaxPoses = 80;

  std::vector<int> row_of_point;           ///< -1 where the point is eliminated.
  std::vector<size_t> block_of_pose_pair;  ///< Index of the block, by pair of poses.

  ReducedCameraStructure() = default;
  ReducedCameraStructure(size_t num_poses, const PosePointPairs& pairs,
                         size_t max_poses = kMaxPoses, std::span<const PosePair> pose_pairs = {});
};

/// The reduced camera system S x = b of the damped normal equations, with S = U - W V^-1 W^T and
/// b = -(g_pose - W V^-1 g_point), and what back substitution needs. With the Cholesky factor
/// V = L L^T of each point, V^-1 = L^-T L^-1.
struct ReducedCameraSystem {
  std::vector<PoseBlock> blocks;                   ///< S, as the structure lists its blocks.
  std::vector<PaddedVector> rhs;                   ///< b, by row.
  std::vector<Eigen::Matrix3d> inverse_factors;    ///< L^-1, by point.
  std::vector<Eigen::Vector3d> reduced_gradients;  ///< L^-1 g_point, by point.
  std::vector<PosePointBlock> reduced_pairs;       ///< W L^-T, by pair.

  /// Step of a point: -V^-1 (g_point + W^T x_pose), or its own unknowns where it was kept.
  /// `solution` is x, by row.
  Eigen::Vector3d BackSubstitute(const PosePointPairs& pairs,
                                 const ReducedCameraStructure& structure, size_t point,
                                 std::span<const PaddedVector> solution) const;
};

/// Forms the Schur complement of the points in the normal equations, damped for a trust region of
/// `radius` (see LevenbergMarquardtDamping). A point that is kept has a row of six unknowns as
/// well, the last three of which are zero. False where the block of a point is not positive
/// definite to rounding.
bool EliminatePoints(const NormalEquations& equations, const PosePointPairs& pairs,
                     const ReducedCameraStructure& structure, double radius,
                     ReducedCameraSystem* system);

}  // namespace orb360
