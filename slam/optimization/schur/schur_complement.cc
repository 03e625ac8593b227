#include "slam/optimization/schur/schur_complement.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "slam/optimization/schur/levenberg_marquardt.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/schur/schur_complement.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eliminates one point. `l` is L^-1 and `pairs` are the blocks W of the point, which become
// `reduced`, W L^-T. Their products are subtracted from the blocks of the pairs of poses. `first`
// and `columns` are those of the reduced camera structure.
void EliminatePoint(const double* l, const double* reduced_gradient, const PosePointBlock* pairs,
                    const int* poses, size_t num_pairs, PosePointBlock* reduced,
                    const size_t* first, const int* columns, PoseBlock* blocks, PaddedVector* rhs) {
  const hn::CappedTag<double, kPaddedRows> d;  // some or all rows of a column
  for (size_t a = 0; a < num_pairs; ++a) {
    const double* w = pairs[a].data();
    double* y = reduced[a].data();
    double* sum = rhs[poses[a]].data();
    for (size_t i = 0; i < kPoseSize; i += hn::Lanes(d)) {
      const auto w0 = hn::LoadU(d, w + i);
      const auto w1 = hn::LoadU(d, w + kPaddedRows + i);
      const auto w2 = hn::LoadU(d, w + 2 * kPaddedRows + i);
      const auto y0 = hn::Mul(w0, hn::Set(d, l[0]));
      const auto y1 = hn::MulAdd(w0, hn::Set(d, l[1]), hn::Mul(w1, hn::Set(d, l[4])));
      const auto y2 = hn::MulAdd(w0, hn::Set(d, l[2]),
                                 hn::MulAdd(w1, hn::Set(d, l[5]), hn::Mul(w2, hn::Set(d, l[8]))));
      hn::StoreU(y0, d, y + i);
      hn::StoreU(y1, d, y + kPaddedRows + i);
      hn::StoreU(y2, d, y + 2 * kPaddedRows + i);
      auto s = hn::LoadU(d, sum + i);
      s = hn::MulAdd(y0, hn::Set(d, reduced_gradient[0]), s);
      s = hn::MulAdd(y1, hn::Set(d, reduced_gradient[1]), s);
      s = hn::MulAdd(y2, hn::Set(d, reduced_gradient[2]), s);
      hn::StoreU(s, d, sum + i);
    }
    size_t index = first[poses[a]];
    for (size_t b = 0; b <= a; ++b) {
      while (columns[index] != poses[b]) ++index;
      const double* other = reduced[b].data();
      double* block = blocks[index].data();
      for (size_t i = 0; i < kPoseSize; i += hn::Lanes(d)) {
        const auto y0 = hn::LoadU(d, y + i);
        const auto y1 = hn::LoadU(d, y + kPaddedRows + i);
        const auto y2 = hn::LoadU(d, y + 2 * kPaddedRows + i);
        for (size_t j = 0; j < kPoseSize; ++j) {
          double* column = block + j * kPaddedRows + i;
          auto rest = hn::LoadU(d, column);
          rest = hn::NegMulAdd(y0, hn::Set(d, other[j]), rest);
          rest = hn::NegMulAdd(y1, hn::Set(d, other[kPaddedRows + j]), rest);
          rest = hn::NegMulAdd(y2, hn::Set(d, other[2 * kPaddedRows + j]), rest);
          hn::StoreU(rest, d, column);
        }
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

HWY_EXPORT(EliminatePoint);

// Inverse of a lower triangular matrix; entries above the diagonal are not read.
Eigen::Matrix3d InverseOfLower(const Eigen::Matrix3d& l) {
  const double a = 1 / l(0, 0);
  const double b = 1 / l(1, 1);
  const double c = 1 / l(2, 2);
  const double low = -b * l(1, 0) * a;
  Eigen::Matrix3d inverse;
  inverse << a, 0, 0,  //
      low, b, 0,       //
      -c * (l(2, 0) * a + l(2, 1) * low), -c * l(2, 1) * b, c;
  return inverse;
}

}  // namespace

ReducedCameraStructure::ReducedCameraStructure(size_t num_poses, const PosePointPairs& pairs,
                                               size_t max_poses,
                                               std::span<const PosePair> pose_pairs) {
  // Duplicates are removed from a row when it has this many more entries than there are poses.
  constexpr size_t kMaxDuplicates = 4096;
  std::vector<std::vector<int>> rows(num_poses);
  for (size_t i = 0; i < num_poses; ++i) rows[i].push_back(static_cast<int>(i));
  for (const auto& [row, other] : pose_pairs) rows[row].push_back(other);
  for (size_t p = 0; p < pairs.num_points(); ++p) {
    const std::span poses(pairs.pose.data() + pairs.first[p],
                          pairs.pose.data() + pairs.first[p + 1]);
    row_of_point.push_back(-1);
    if (poses.size() > max_poses) {
      row_of_point.back() = static_cast<int>(rows.size());
      rows.emplace_back(poses.begin(), poses.end()).push_back(row_of_point.back());
      continue;
    }
    for (size_t a = 0; a < poses.size(); ++a) {
      std::vector<int>& row = rows[poses[a]];
      row.insert(row.end(), poses.begin(), poses.begin() + a);
      if (row.size() > kMaxDuplicates + num_poses) SortUnique(&row);
    }
  }
  for (std::vector<int>& row : rows) {
    SortUnique(&row);
    column.insert(column.end(), row.begin(), row.end());
    first.push_back(column.size());
  }
  for (const auto& [row, other] : pose_pairs) {
    const auto begin = column.begin() + static_cast<std::ptrdiff_t>(first[row]);
    const auto end = column.begin() + static_cast<std::ptrdiff_t>(first[row + 1]);
    block_of_pose_pair.push_back(std::lower_bound(begin, end, other) - column.begin());
  }
}

Eigen::Vector3d ReducedCameraSystem::BackSubstitute(const PosePointPairs& pairs,
                                                    const ReducedCameraStructure& structure,
                                                    size_t point,
                                                    std::span<const PaddedVector> solution) const {
  const int row = structure.row_of_point[point];
  if (row >= 0) return solution[row].head<3>();
  Eigen::Vector3d rest = -reduced_gradients[point];
  for (size_t a = pairs.first[point]; a < pairs.first[point + 1]; ++a) {
    rest -= reduced_pairs[a].topRows<kPoseSize>().transpose() *
            solution[pairs.pose[a]].head<kPoseSize>();
  }
  return inverse_factors[point].transpose() * rest;
}

bool EliminatePoints(const NormalEquations& equations, const PosePointPairs& pairs,
                     const ReducedCameraStructure& structure, double radius,
                     ReducedCameraSystem* system) {
  std::vector<PoseBlock>& blocks = system->blocks;
  std::vector<PaddedVector>& rhs = system->rhs;
  blocks.assign(structure.column.size(), PoseBlock::Zero());
  rhs.assign(structure.num_rows(), PaddedVector::Zero());
  for (size_t i = 0; i < equations.pose_hessian.size(); ++i) {
    PoseBlock& block = blocks[structure.first[i + 1] - 1];
    block = equations.pose_hessian[i];
    const Eigen::Matrix<double, kPoseSize, 1> diagonal = block.diagonal();
    block.diagonal() += LevenbergMarquardtDamping(diagonal, radius);
    rhs[i] = -equations.pose_gradient[i];
  }
  for (size_t i = 0; i < equations.pose_pair_hessian.size(); ++i) {
    blocks[structure.block_of_pose_pair[i]] += equations.pose_pair_hessian[i];
  }
  const size_t num_points = equations.point_hessian.size();
  system->inverse_factors.resize(num_points);
  system->reduced_gradients.resize(num_points);
  system->reduced_pairs.resize(equations.pair_hessian.size());
  const auto eliminate = HWY_DYNAMIC_DISPATCH(EliminatePoint);
  for (size_t p = 0; p < num_points; ++p) {
    Eigen::Matrix3d damped = equations.point_hessian[p];
    const Eigen::Vector3d diagonal = damped.diagonal();
    damped.diagonal() += LevenbergMarquardtDamping(diagonal, radius);
    const size_t first = pairs.first[p];
    const size_t num_pairs = pairs.first[p + 1] - first;
    if (const int row = structure.row_of_point[p]; row >= 0) {
      PoseBlock* block = blocks.data() + structure.first[row];
      for (size_t a = 0; a < num_pairs; ++a, ++block) {
        block->topRows<3>() = equations.pair_hessian[first + a].topRows<kPoseSize>().transpose();
      }
      block->diagonal().setOnes();
      block->topLeftCorner<3, 3>() = damped;
      rhs[row].head<3>() = -equations.point_gradient[p];
      continue;
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(damped);
    if (factor.info() != Eigen::Success) return false;
    system->inverse_factors[p] = InverseOfLower(factor.matrixLLT());
    system->reduced_gradients[p] = system->inverse_factors[p] * equations.point_gradient[p];
    eliminate(system->inverse_factors[p].data(), system->reduced_gradients[p].data(),
              equations.pair_hessian.data() + first, pairs.pose.data() + first, num_pairs,
              system->reduced_pairs.data() + first, structure.first.data(), structure.column.data(),
              blocks.data(), rhs.data());
  }
  return true;
}

}  // namespace orb360
#endif
