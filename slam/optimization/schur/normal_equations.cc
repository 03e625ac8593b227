#include "slam/optimization/schur/normal_equations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/schur/normal_equations.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void Accumulate(const PosePointPairs& pairs, const ResidualBlocks& blocks, size_t begin,
                const JacobianRow* rows, const double* weights, size_t count,
                NormalEquations* equations) {
  const hn::CappedTag<double, kPaddedRows> d;  // some or all rows of a column
  const size_t num_rows = blocks.num_rows();
  for (size_t b = 0; b < count; ++b) {
    double* v = equations->point_hessian[blocks.point[begin + b]].data();
    double* point_gradient = equations->point_gradient[blocks.point[begin + b]].data();
    const int pair = blocks.pair[begin + b];
    for (const JacobianRow* row = rows + b * num_rows; row != rows + (b + 1) * num_rows; ++row) {
      double weighted_by_point[3];
      for (size_t k = 0; k < 3; ++k) weighted_by_point[k] = weights[b] * row->by_point[k];
      for (size_t k = 0; k < 3; ++k) {
        for (size_t m = 0; m < 3; ++m) v[3 * k + m] += weighted_by_point[k] * row->by_point[m];
        point_gradient[k] += weighted_by_point[k] * row->residual;
      }
      if (pair < 0) continue;
      const int pose = pairs.pose[pair];
      double* u = equations->pose_hessian[pose].data();
      double* gradient = equations->pose_gradient[pose].data();
      double* w = equations->pair_hessian[pair].data();
      for (size_t i = 0; i < kPoseSize; i += hn::Lanes(d)) {
        const auto by_pose = hn::LoadU(d, row->by_pose.data() + i);
        const auto weighted_by_pose = hn::Mul(by_pose, hn::Set(d, weights[b]));
        const auto add = [&](auto column, double factor, double* to) HWY_ATTR {
          hn::StoreU(hn::MulAdd(column, hn::Set(d, factor), hn::LoadU(d, to + i)), d, to + i);
        };
        for (size_t j = 0; j < kPoseSize; ++j) {
          add(weighted_by_pose, row->by_pose[j], u + j * kPaddedRows);
        }
        for (size_t k = 0; k < 3; ++k) add(by_pose, weighted_by_point[k], w + k * kPaddedRows);
        add(weighted_by_pose, row->residual, gradient);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(Accumulate);

}  // namespace

void NormalEquations::SetZero(size_t num_poses, const PosePointPairs& pairs,
                              size_t num_pose_pairs) {
  pose_hessian.assign(num_poses, PoseBlock::Zero());
  pose_gradient.assign(num_poses, PaddedVector::Zero());
  point_hessian.assign(pairs.num_points(), Eigen::Matrix3d::Zero());
  point_gradient.assign(pairs.num_points(), Eigen::Vector3d::Zero());
  pair_hessian.assign(pairs.pose.size(), PosePointBlock::Zero());
  pose_pair_hessian.assign(num_pose_pairs, PoseBlock::Zero());
}

void NormalEquations::Accumulate(const PosePointPairs& pairs, const ResidualBlocks& blocks,
                                 size_t begin, std::span<const JacobianRow> rows,
                                 std::span<const double> weights) {
  HWY_DYNAMIC_DISPATCH(Accumulate)
  (pairs, blocks, begin, rows.data(), weights.data(), weights.size(), this);
}

}  // namespace orb360
#endif
