#include "slam/optimization/schur/bundle_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "slam/optimization/bundle_loss.h"
#include "slam/optimization/point_residual.h"
#include "slam/optimization/schur/block_structure.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

PackedState Pack(const BundleState& state) {
  PackedState packed;
  packed.poses.reserve(12 * state.camera_from_world.size());
  for (const Rigid3& pose : state.camera_from_world) {
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) packed.poses.push_back(rotation(row, column));
      packed.poses.push_back(pose.translation[row]);
    }
  }
  packed.points.reserve(3 * state.points.size());
  for (const Eigen::Vector3d& point : state.points) {
    packed.points.insert(packed.points.end(), {point.x(), point.y(), point.z()});
  }
  return packed;
}

// Finds the pairs of a free pose and a point with residual blocks in common, and tells the blocks.
PosePointPairs FindPairs(const std::vector<int>& free_index, size_t num_points,
                         std::array<ResidualBlocks, 3>* all) {
  std::vector<std::vector<int>> poses_of(num_points);
  for (const ResidualBlocks& blocks : *all) {
    for (size_t i = 0; i < blocks.size; ++i) {
      const int pose = free_index[blocks.pose[i]];
      if (pose >= 0) poses_of[blocks.point[i]].push_back(pose);
    }
  }
  PosePointPairs pairs;
  for (std::vector<int>& poses : poses_of) {
    SortUnique(&poses);
    pairs.pose.insert(pairs.pose.end(), poses.begin(), poses.end());
    pairs.first.push_back(pairs.pose.size());
  }
  for (ResidualBlocks& blocks : *all) {
    for (size_t i = 0; i < blocks.size; ++i) {
      const int pose = free_index[blocks.pose[i]];
      if (pose < 0) continue;
      const std::vector<int>& poses = poses_of[blocks.point[i]];
      const auto index = std::ranges::lower_bound(poses, pose) - poses.begin();
      blocks.pair[i] = static_cast<int>(pairs.first[blocks.point[i]]) + static_cast<int>(index);
    }
  }
  return pairs;
}

PosePair SortedPair(int a, int b) { return {std::max(a, b), std::min(a, b)}; }

}  // namespace

BundleEvaluator::BundleEvaluator(BundleLoss loss, const BundleProblem& problem)
    : blocks_(MakeResidualBlocks(problem)), distances_(problem.distances) {
  losses_[ResidualBlocks::kDirection] = DirectionLoss(loss);
  losses_[ResidualBlocks::kHeight] = HeightLoss();
  losses_[ResidualBlocks::kRange] = RangeLoss();
  for (const uint8_t is_fixed : problem.pose_fixed) {
    free_index_.push_back(is_fixed ? -1 : num_free_poses_++);
  }
  pairs_ = FindPairs(free_index_, problem.points.size(), &blocks_);
  for (const BundleProblem::Distance& distance : distances_) {
    const int free1 = free_index_[distance.pose1];
    const int free2 = free_index_[distance.pose2];
    ORB360_CHECK(distance.pose1 != distance.pose2, distance.pose1);
    if (free1 >= 0 && free2 >= 0) pose_pairs_.push_back(SortedPair(free1, free2));
  }
  SortUnique(&pose_pairs_);
}

double BundleEvaluator::Evaluate(const BundleState& state, NormalEquations* equations) const {
  constexpr size_t kBatch = 16 * kMaxLanes;  // 24 KB of rows, which fit into the first-level cache
  const PackedState packed = Pack(state);
  std::vector<double> squared_norms(kBatch);
  std::vector<double> weights(kBatch);
  std::vector<JacobianRow> rows(equations == nullptr ? 0 : 2 * kBatch);
  double cost = 0;
  for (const ResidualBlocks& blocks : blocks_) {
    const RobustLoss& loss = losses_[blocks.kind];
    for (size_t begin = 0; begin < blocks.size; begin += kBatch) {
      const size_t count = std::min(kBatch, blocks.size - begin);
      const size_t padded_count = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
      EvaluateResidualBlocks(blocks, begin, packed, std::span(squared_norms).first(padded_count),
                             rows);
      for (size_t i = 0; i < count; ++i) {
        if (!std::isfinite(squared_norms[i])) return std::numeric_limits<double>::infinity();
        // The slope of the loss is the weight of a block. The second-order correction of Triggs is
        // left out, as Ceres leaves it out for losses with negative curvature.
        const RobustLoss::Value value = loss(squared_norms[i]);
        cost += 0.5 * value.rho;
        weights[i] = value.slope;
      }
      if (equations != nullptr) {
        equations->Accumulate(pairs_, blocks, begin, rows, std::span(weights).first(count));
      }
    }
  }
  return cost + EvaluateDistances(state, equations);
}

double BundleEvaluator::EvaluateDistances(const BundleState& state,
                                          NormalEquations* equations) const {
  double cost = 0;
  for (const BundleProblem::Distance& distance : distances_) {
    const Rigid3& pose1 = state.camera_from_world[distance.pose1];
    const Rigid3& pose2 = state.camera_from_world[distance.pose2];
    const Eigen::Vector3d between = pose2.Inverse().translation - pose1.Inverse().translation;
    PointJacobian by_between;
    const double residual =
        RangeResidual(distance.distance, distance.sigma)(between, &by_between).x();
    if (!std::isfinite(residual)) return std::numeric_limits<double>::infinity();
    const RobustLoss::Value loss = DistanceLoss()(residual * residual);
    cost += 0.5 * loss.rho;
    if (equations == nullptr) continue;
    // A rotation leaves the camera's centre where it is; a translation d of camera_from_world moves
    // it by -R^T d.
    const Eigen::Vector3d across = by_between.row(0).transpose();
    PaddedVector by_pose1 = PaddedVector::Zero();
    PaddedVector by_pose2 = PaddedVector::Zero();
    by_pose1.segment<3>(3) = pose1.rotation * across;
    by_pose2.segment<3>(3) = -(pose2.rotation * across);
    const int free1 = free_index_[distance.pose1];
    const int free2 = free_index_[distance.pose2];
    const auto add = [&](int free, const PaddedVector& by_pose) {
      if (free < 0) return;
      equations->pose_hessian[free] += loss.slope * by_pose * by_pose.head<kPoseSize>().transpose();
      equations->pose_gradient[free] += loss.slope * residual * by_pose;
    };
    add(free1, by_pose1);
    add(free2, by_pose2);
    if (free1 < 0 || free2 < 0) continue;
    const auto pair = std::ranges::lower_bound(pose_pairs_, SortedPair(free1, free2));
    const bool is_first_row = free1 > free2;
    equations->pose_pair_hessian[pair - pose_pairs_.begin()] +=
        loss.slope * (is_first_row ? by_pose1 : by_pose2) *
        (is_first_row ? by_pose2 : by_pose1).head<kPoseSize>().transpose();
  }
  return cost;
}

double BundleEvaluator::Cost(const BundleState& state) const { return Evaluate(state, nullptr); }

double BundleEvaluator::Linearize(const BundleState& state, NormalEquations* equations) const {
  equations->SetZero(static_cast<size_t>(num_free_poses_), pairs_, pose_pairs_.size());
  return Evaluate(state, equations);
}

BundleState BundleEvaluator::Plus(const BundleState& state, const BundleStep& step) const {
  BundleState result = state;
  for (size_t i = 0; i < free_index_.size(); ++i) {
    if (free_index_[i] < 0) continue;
    const PaddedVector& delta = step.poses[free_index_[i]];
    result.camera_from_world[i] =
        Rigid3{ExpSo3(delta.head<3>()), delta.segment<3>(3)} * result.camera_from_world[i];
  }
  for (size_t p = 0; p < result.points.size(); ++p) result.points[p] += step.points[p];
  return result;
}

}  // namespace orb360
