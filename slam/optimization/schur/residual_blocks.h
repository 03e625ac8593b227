#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "slam/optimization/bundle_problem.h"

namespace orb360 {

/// The most residual blocks that a vector instruction evaluates at once.
inline constexpr size_t kMaxLanes = 8;

/// The residual blocks of one kind (point_residual.h), as a structure of arrays. A block depends on
/// one pose and one point.
struct ResidualBlocks {
  enum Kind { kDirection, kHeight, kRange };
  static constexpr size_t kMaxConstants = 6;

  Kind kind = kDirection;
  size_t size = 0;
  std::vector<int> pose;
  std::vector<int> point;
  std::vector<int> pair;  ///< See PosePointPairs; -1 where the pose is fixed.
  /// The constants of the residuals, padded to a multiple of kMaxLanes. For a direction, the scaled
  /// basis of its tangent plane, column by column; for a height, its direction and offset; for a
  /// range, its logarithm and weight.
  std::array<std::vector<double>, kMaxConstants> constants;

  size_t num_rows() const { return kind == kDirection ? 2 : 1; }
};

/// Makes the residual blocks of a problem, one element for each kind. Their `pair` is -1.
std::array<ResidualBlocks, 3> MakeResidualBlocks(const BundleProblem& problem);

/// One row of a residual block and of its Jacobian.
struct JacobianRow {
  /// By the six unknowns of the pose (see BundleState), padded with zeros.
  std::array<double, 8> by_pose;
  std::array<double, 3> by_point;
  double residual;
};

/// Poses and points packed for gathering by vector instructions.
struct PackedState {
  std::vector<double> poses;   ///< camera_from_world: [R t] row by row, 12 numbers each.
  std::vector<double> points;  ///< 3 numbers each.
};

/// Evaluates the blocks from `begin`, a multiple of kMaxLanes, on. `squared_norms` receives the
/// squared norm of each residual; it is not finite where the residual is not defined. `rows`,
/// unless empty, receives the rows of each block one after another. Whole vectors are written: the
/// length of `squared_norms` is a multiple of kMaxLanes and exceeds the number of blocks by less
/// than that.
void EvaluateResidualBlocks(const ResidualBlocks& blocks, size_t begin, const PackedState& state,
                            std::span<double> squared_norms, std::span<JacobianRow> rows);

}  // namespace orb360
