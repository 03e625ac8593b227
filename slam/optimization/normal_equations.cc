#include "slam/optimization/normal_equations.h"

#include <algorithm>

#include <Eigen/Cholesky>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/normal_equations.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Blocks are columns of kPoseRows numbers; a vector takes some or all rows of a column. Rows past
// the sixth are zero and need not be visited.
using D = hn::CappedTag<double, kPoseRows>;
constexpr size_t kRows = 6;

void AddTerms(const BundleLinks& structure, const BundleTerms& terms, size_t begin,
              const TermRow* rows, const double* weights, size_t count,
              NormalEquations* equations) {
  const D d;
  const size_t rows_per_term = terms.num_rows();
  for (size_t t = 0; t < count; ++t) {
    double* point = equations->points[terms.point[begin + t]].data();
    double* point_gradient = equations->point_gradients[terms.point[begin + t]].data();
    const int link = terms.link[begin + t];
    for (const TermRow* row = rows + t * rows_per_term; row != rows + (t + 1) * rows_per_term;
         ++row) {
      double by_point[3];  // weighted
      for (size_t k = 0; k < 3; ++k) by_point[k] = weights[t] * row->by_point[k];
      for (size_t k = 0; k < 3; ++k) {
        for (size_t m = 0; m < 3; ++m) point[3 * k + m] += by_point[k] * row->by_point[m];
        point_gradient[k] += by_point[k] * row->residual;
      }
      if (link < 0) continue;
      const int pose = structure.pose[link];
      double* block = equations->poses[pose].data();
      double* gradient = equations->pose_gradients[pose].data();
      double* shared = equations->links[link].data();
      for (size_t i = 0; i < kRows; i += hn::Lanes(d)) {
        const auto derivative = hn::LoadU(d, row->by_pose.data() + i);
        const auto weighted = hn::Mul(derivative, hn::Set(d, weights[t]));
        const auto add = [&](auto by_pose, double factor, double* to) HWY_ATTR {
          hn::StoreU(hn::MulAdd(by_pose, hn::Set(d, factor), hn::LoadU(d, to + i)), d, to + i);
        };
        for (size_t j = 0; j < kRows; ++j) add(weighted, row->by_pose[j], block + j * kPoseRows);
        for (size_t k = 0; k < 3; ++k) add(derivative, by_point[k], shared + k * kPoseRows);
        add(weighted, row->residual, gradient);
      }
    }
  }
}

// One point: `inverse` is L^-1 by columns, `links` W, to become `reduced` W L^-T. Takes their
// products off the blocks of the pairs of poses; `first` and `columns` are those of
// ReducedStructure.
void EliminatePoint(const double* inverse, const double* point_sum, const PosePointBlock* links,
                    const int* poses, size_t num_links, PosePointBlock* reduced,
                    const size_t* first, const int* columns, PoseBlock* blocks, PoseVector* sums) {
  const D d;
  const double* l = inverse;
  for (size_t a = 0; a < num_links; ++a) {
    const double* w = links[a].data();
    double* y = reduced[a].data();
    double* sum = sums[poses[a]].data();
    for (size_t i = 0; i < kRows; i += hn::Lanes(d)) {
      const auto w0 = hn::LoadU(d, w + i);
      const auto w1 = hn::LoadU(d, w + kPoseRows + i);
      const auto w2 = hn::LoadU(d, w + 2 * kPoseRows + i);
      const auto y0 = hn::Mul(w0, hn::Set(d, l[0]));
      const auto y1 = hn::MulAdd(w0, hn::Set(d, l[1]), hn::Mul(w1, hn::Set(d, l[4])));
      const auto y2 = hn::MulAdd(w0, hn::Set(d, l[2]),
                                 hn::MulAdd(w1, hn::Set(d, l[5]), hn::Mul(w2, hn::Set(d, l[8]))));
      hn::StoreU(y0, d, y + i);
      hn::StoreU(y1, d, y + kPoseRows + i);
      hn::StoreU(y2, d, y + 2 * kPoseRows + i);
      auto s = hn::LoadU(d, sum + i);
      s = hn::MulAdd(y0, hn::Set(d, point_sum[0]), s);
      s = hn::MulAdd(y1, hn::Set(d, point_sum[1]), s);
      s = hn::MulAdd(y2, hn::Set(d, point_sum[2]), s);
      hn::StoreU(s, d, sum + i);
    }
    size_t pair = first[poses[a]];
    for (size_t b = 0; b <= a; ++b) {
      while (columns[pair] != poses[b]) ++pair;
      const double* other = reduced[b].data();
      double* block = blocks[pair].data();
      for (size_t i = 0; i < kRows; i += hn::Lanes(d)) {
        const auto y0 = hn::LoadU(d, y + i);
        const auto y1 = hn::LoadU(d, y + kPoseRows + i);
        const auto y2 = hn::LoadU(d, y + 2 * kPoseRows + i);
        for (size_t j = 0; j < kRows; ++j) {
          double* column = block + j * kPoseRows + i;
          auto left = hn::LoadU(d, column);
          left = hn::NegMulAdd(y0, hn::Set(d, other[j]), left);
          left = hn::NegMulAdd(y1, hn::Set(d, other[kPoseRows + j]), left);
          left = hn::NegMulAdd(y2, hn::Set(d, other[2 * kPoseRows + j]), left);
          hn::StoreU(left, d, column);
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

HWY_EXPORT(AddTerms);
HWY_EXPORT(EliminatePoint);

/// Of the lower triangle; what is above counts as zero.
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

void NormalEquations::Clear(size_t num_poses, const BundleLinks& structure) {
  const size_t num_points = structure.first.size() - 1;
  poses.assign(num_poses, PoseBlock::Zero());
  pose_gradients.assign(num_poses, PoseVector::Zero());
  points.assign(num_points, Eigen::Matrix3d::Zero());
  point_gradients.assign(num_points, Eigen::Vector3d::Zero());
  links.assign(structure.pose.size(), PosePointBlock::Zero());
}

void NormalEquations::Add(const BundleLinks& structure, const BundleTerms& terms, size_t begin,
                          std::span<const TermRow> rows, std::span<const double> weights) {
  HWY_DYNAMIC_DISPATCH(AddTerms)
  (structure, terms, begin, rows.data(), weights.data(), weights.size(), this);
}

Eigen::Vector3d ReducedEquations::PointStep(const BundleLinks& links_of_points,
                                            const ReducedStructure& structure, size_t point,
                                            std::span<const PoseVector> steps) const {
  const int row = structure.row_of_point[point];
  if (row >= 0) return steps[row].head<3>();
  Eigen::Vector3d rest = -point_sums[point];
  for (size_t a = links_of_points.first[point]; a < links_of_points.first[point + 1]; ++a) {
    rest -= links[a].topRows<6>().transpose() * steps[links_of_points.pose[a]].head<6>();
  }
  return inverses[point].transpose() * rest;
}

ReducedStructure::ReducedStructure(size_t num_poses, const BundleLinks& links, size_t max_poses) {
  std::vector<std::vector<int>> rows(num_poses);
  const auto tidy = [](std::vector<int>* row) {
    std::ranges::sort(*row);
    row->erase(std::ranges::unique(*row).begin(), row->end());
  };
  constexpr size_t kMany = 4096;  // before what is there several times is removed
  for (size_t i = 0; i < num_poses; ++i) rows[i].push_back(static_cast<int>(i));
  for (size_t p = 0; p + 1 < links.first.size(); ++p) {
    const std::span poses(links.pose.data() + links.first[p],
                          links.pose.data() + links.first[p + 1]);
    row_of_point.push_back(-1);
    if (poses.size() > max_poses) {
      row_of_point.back() = static_cast<int>(rows.size());
      rows.emplace_back(poses.begin(), poses.end()).push_back(row_of_point.back());
      continue;
    }
    for (size_t a = 0; a < poses.size(); ++a) {
      std::vector<int>& row = rows[poses[a]];
      row.insert(row.end(), poses.begin(), poses.begin() + a);
      if (row.size() > kMany + num_poses) tidy(&row);
    }
  }
  for (std::vector<int>& row : rows) {
    tidy(&row);
    column.insert(column.end(), row.begin(), row.end());
    first.push_back(column.size());
  }
}

bool EliminatePoints(const NormalEquations& equations, const BundleLinks& links,
                     const ReducedStructure& structure, double radius, ReducedEquations* reduced) {
  std::vector<PoseBlock>& blocks = reduced->blocks;
  std::vector<PoseVector>& sums = reduced->sums;
  blocks.assign(structure.column.size(), PoseBlock::Zero());
  sums.assign(structure.num_rows(), PoseVector::Zero());
  for (size_t i = 0; i < equations.poses.size(); ++i) {
    PoseBlock& block = blocks[structure.first[i + 1] - 1];
    block = equations.poses[i];
    const Eigen::Matrix<double, 6, 1> diagonal = block.diagonal();
    block.diagonal() += Damping(diagonal, radius);
    sums[i] = -equations.pose_gradients[i];
  }
  const size_t num_points = equations.points.size();
  reduced->inverses.resize(num_points);
  reduced->point_sums.resize(num_points);
  reduced->links.resize(equations.links.size());
  const auto eliminate = HWY_DYNAMIC_DISPATCH(EliminatePoint);
  for (size_t p = 0; p < num_points; ++p) {
    Eigen::Matrix3d damped = equations.points[p];
    const Eigen::Vector3d diagonal = damped.diagonal();
    damped.diagonal() += Damping(diagonal, radius);
    const size_t first = links.first[p];
    const size_t num_links = links.first[p + 1] - first;
    if (const int row = structure.row_of_point[p]; row >= 0) {
      PoseBlock* block = blocks.data() + structure.first[row];
      for (size_t a = 0; a < num_links; ++a, ++block) {
        block->topRows<3>() = equations.links[first + a].topRows<6>().transpose();
      }
      block->diagonal().setOnes();
      block->topLeftCorner<3, 3>() = damped;
      sums[row].head<3>() = -equations.point_gradients[p];
      continue;
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(damped);
    if (factor.info() != Eigen::Success) return false;
    reduced->inverses[p] = InverseOfLower(factor.matrixLLT());
    reduced->point_sums[p] = reduced->inverses[p] * equations.point_gradients[p];
    eliminate(reduced->inverses[p].data(), reduced->point_sums[p].data(),
              equations.links.data() + first, links.pose.data() + first, num_links,
              reduced->links.data() + first, structure.first.data(), structure.column.data(),
              blocks.data(), sums.data());
  }
  return true;
}

}  // namespace orb360
#endif
