#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/optimization/bundle_terms.h"

namespace orb360 {

/// Rows of a pose's blocks: its six unknowns, filled up to whole vectors with zeros.
inline constexpr int kPoseRows = 8;
using PoseVector = Eigen::Matrix<double, kPoseRows, 1>;
using PoseBlock = Eigen::Matrix<double, kPoseRows, 6>;
using PosePointBlock = Eigen::Matrix<double, kPoseRows, 3>;

/// Which poses that move see which points: the structure of the normal equations. A link is a pose
/// and a point with residuals in common.
struct BundleLinks {
  std::vector<int> pose;            // by link; those of a point in rising order
  std::vector<size_t> first = {0};  // link by point, and the end
};

/// Structure of what is left when the points are eliminated, by rows of the lower triangle: which
/// pairs of poses see a point in common. A point that more than `max_poses` of them see stays, in a
/// row behind the poses': eliminated, it would link each of them with each other, and a few clouds
/// or towers that are seen from everywhere would make a full matrix of a sparse one.
struct ReducedStructure {
  static constexpr size_t kMaxPoses = 80;

  std::vector<size_t> first = {0};  // block by row, and the end
  std::vector<int> column;          // by block; those of a row rise, the last is the row itself
  std::vector<int> row_of_point;    // -1 where it is eliminated

  ReducedStructure() = default;
  ReducedStructure(size_t num_poses, const BundleLinks& links, size_t max_poses = kMaxPoses);

  size_t num_rows() const { return first.size() - 1; }
};

/// The normal equations of a bundle of poses and points: J^T J in blocks, and the gradient J^T r.
struct NormalEquations {
  std::vector<PoseBlock> poses;
  std::vector<PoseVector> pose_gradients;
  std::vector<Eigen::Matrix3d> points;
  std::vector<Eigen::Vector3d> point_gradients;
  std::vector<PosePointBlock> links;

  /// All zero.
  void Clear(size_t num_poses, const BundleLinks& structure);

  /// Adds the terms from `begin` on, as many as there are `weights`, with what EvaluateTerms made
  /// of them.
  void Add(const BundleLinks& structure, const BundleTerms& terms, size_t begin,
           std::span<const TermRow> rows, std::span<const double> weights);
};

/// What is left of the equations when the points are eliminated: a system of the poses and of the
/// points that stay (of six unknowns as well, the last three of which are zero), and what it takes
/// to come back to the others.
struct ReducedEquations {
  std::vector<PoseBlock> blocks;            // as the structure lists them
  std::vector<PoseVector> sums;             // right hand sides, by row
  std::vector<Eigen::Matrix3d> inverses;    // L^-1, where L L^T is a point's block, damped
  std::vector<Eigen::Vector3d> point_sums;  // L^-1 times a point's gradient
  std::vector<PosePointBlock> links;        // W L^-T

  /// How a point moves where the rows' unknowns are `steps`.
  Eigen::Vector3d PointStep(const BundleLinks& links_of_points, const ReducedStructure& structure,
                            size_t point, std::span<const PoseVector> steps) const;
};

/// Marquardt's damping of a diagonal, as Ceres does it. `radius` of the trust region.
template <typename Vector>
Vector Damping(const Vector& diagonal, double radius) {
  constexpr double kMinDiagonal = 1e-6;
  return diagonal.cwiseMax(kMinDiagonal) / radius;
}

/// Eliminates points of the damped equations (Schur complement). False where the block of one is
/// not positive definite to rounding.
bool EliminatePoints(const NormalEquations& equations, const BundleLinks& links,
                     const ReducedStructure& structure, double radius, ReducedEquations* reduced);

}  // namespace orb360
