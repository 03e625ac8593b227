#include "slam/optimization/schur/bundle_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "slam/optimization/bundle_loss.h"
#include "slam/optimization/point_residual.h"
#include "slam/optimization/schur/block_structure.h"
#include "slam/optimization/shared_point_residual.h"
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
    : blocks_(MakeResidualBlocks(problem)), shared_points_(problem.shared_points) {
  losses_[ResidualBlocks::kDirection] = DirectionLoss(loss);
  losses_[ResidualBlocks::kHeight] = HeightLoss();
  losses_[ResidualBlocks::kRange] = RangeLoss();
  for (const uint8_t is_fixed : problem.pose_fixed) {
    free_index_.push_back(is_fixed ? -1 : num_free_poses_++);
  }
  pairs_ = FindPairs(free_index_, problem.points.size(), &blocks_);
  for (const BundleProblem::SharedPoint& shared : shared_points_) {
    const int free1 = free_index_[shared.pose1];
    const int free2 = free_index_[shared.pose2];
    ORB360_CHECK(shared.pose1 != shared.pose2, shared.pose1);
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
  return cost + EvaluateSharedPoints(state, equations);
}

double BundleEvaluator::EvaluateSharedPoints(const BundleState& state,
                                             NormalEquations* equations) const {
  double cost = 0;
  for (const BundleProblem::SharedPoint& shared : shared_points_) {
    SharedPointJacobian by_pose1;
    SharedPointJacobian by_pose2;
    const bool is_linearized = equations != nullptr;
    const Eigen::Vector2d residual = SharedPointResidual(
        shared, state.camera_from_world[shared.pose1], state.camera_from_world[shared.pose2],
        is_linearized ? &by_pose1 : nullptr, is_linearized ? &by_pose2 : nullptr);
    if (!residual.allFinite()) return std::numeric_limits<double>::infinity();
    const RobustLoss::Value loss = SharedPointLoss()(residual.squaredNorm());
    cost += 0.5 * loss.rho;
    if (!is_linearized) continue;
    const int free1 = free_index_[shared.pose1];
    const int free2 = free_index_[shared.pose2];
    const auto add = [&](int free, const SharedPointJacobian& by_pose) {
      if (free < 0) return;
      equations->pose_hessian[free].topRows<kPoseSize>() +=
          loss.slope * by_pose.transpose() * by_pose;
      equations->pose_gradient[free].head<kPoseSize>() +=
          loss.slope * by_pose.transpose() * residual;
    };
    add(free1, by_pose1);
    add(free2, by_pose2);
    if (free1 < 0 || free2 < 0) continue;
    const auto pair = std::ranges::lower_bound(pose_pairs_, SortedPair(free1, free2));
    const bool is_first_row = free1 > free2;
    equations->pose_pair_hessian[pair - pose_pairs_.begin()].topRows<kPoseSize>() +=
        loss.slope * (is_first_row ? by_pose1 : by_pose2).transpose() *
        (is_first_row ? by_pose2 : by_pose1);
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
