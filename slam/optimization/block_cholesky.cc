#include "slam/optimization/block_cholesky.h"

#include <algorithm>
#include <cstdint>

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include "nn/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/block_cholesky.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Blocks are columns of kPoseRows numbers; a vector takes some or all rows of a column.
using D = hn::CappedTag<double, kPoseRows>;
constexpr size_t kRows = 6;

// to -= a b^T
void SubtractProduct(const PoseBlock& a, const PoseBlock& b, PoseBlock* to) {
  const D d;
  for (size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    const auto column = [&](size_t m)
                            HWY_ATTR { return hn::LoadU(d, a.data() + m * kPoseRows + i); };
    const auto a0 = column(0), a1 = column(1), a2 = column(2);
    const auto a3 = column(3), a4 = column(4), a5 = column(5);
    for (size_t c = 0; c < kRows; ++c) {
      const double* factors = b.data() + c;
      double* at = to->data() + c * kPoseRows + i;
      const auto factor = [&](size_t m) HWY_ATTR { return hn::Set(d, factors[m * kPoseRows]); };
      // Two sums, so that one does not wait for the other.
      auto even = hn::NegMulAdd(a0, factor(0), hn::LoadU(d, at));
      auto odd = hn::Mul(a1, factor(1));
      even = hn::NegMulAdd(a2, factor(2), even);
      odd = hn::MulAdd(a3, factor(3), odd);
      even = hn::NegMulAdd(a4, factor(4), even);
      odd = hn::MulAdd(a5, factor(5), odd);
      hn::StoreU(hn::Sub(even, odd), d, at);
    }
  }
}

// What a column of L, whose blocks below the diagonal are `column` in the rows `rows`, takes off
// the columns of these rows.
void UpdateColumns(const PoseBlock* column, const int* rows, size_t count, const size_t* first,
                   const int* row_of, PoseBlock* blocks) {
  for (size_t j = 0; j < count; ++j) {
    size_t at = first[rows[j]];
    for (size_t i = j; i < count; ++i) {
      while (row_of[at] != rows[i]) ++at;
      SubtractProduct(column[i], column[j], blocks + at);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(UpdateColumns);

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Poses in the order of their elimination.
std::vector<int> OrderPoses(const PosePairs& pairs) {
  const int count = static_cast<int>(pairs.num_poses());
  std::vector<Eigen::Triplet<int>> entries;
  for (int i = 0; i < count; ++i) {
    for (size_t b = pairs.first[i]; b < pairs.first[i + 1]; ++b) {
      entries.emplace_back(i, pairs.column[b], 1);
      entries.emplace_back(pairs.column[b], i, 1);
    }
  }
  Eigen::SparseMatrix<int> pattern(count, count);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  const auto& indices = order.indices();
  return {indices.data(), indices.data() + indices.size()};
}

}  // namespace

BlockCholesky::BlockCholesky(const PosePairs& pairs) : pose_at_(OrderPoses(pairs)) {
  const int count = static_cast<int>(pairs.num_poses());
  std::vector<int> place_of(count);
  for (int place = 0; place < count; ++place) place_of[pose_at_[place]] = place;
  std::vector<std::vector<int>> below(count);  // by column: rows of blocks that are not zero
  for (int i = 0; i < count; ++i) {
    for (size_t b = pairs.first[i]; b < pairs.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(place_of[i], place_of[pairs.column[b]]);
      if (row != column) below[column].push_back(row);
    }
  }
  for (int k = 0; k < count; ++k) {
    std::vector<int>& rows = below[k];
    std::ranges::sort(rows);
    rows.erase(std::ranges::unique(rows).begin(), rows.end());
    row_.push_back(k);
    row_.insert(row_.end(), rows.begin(), rows.end());
    first_.push_back(row_.size());
    // Where a column has blocks, the first of its rows' column gets some as well.
    if (rows.empty()) continue;
    std::vector<int>& next = below[rows.front()];
    next.insert(next.end(), rows.begin() + 1, rows.end());
  }
  for (int i = 0; i < count; ++i) {
    for (size_t b = pairs.first[i]; b < pairs.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(place_of[i], place_of[pairs.column[b]]);
      const auto begin = row_.begin() + static_cast<std::ptrdiff_t>(first_[column]);
      const auto end = row_.begin() + static_cast<std::ptrdiff_t>(first_[column + 1]);
      source_block_.push_back(
          static_cast<size_t>(std::lower_bound(begin, end, row) - row_.begin()));
      is_turned_.push_back(place_of[i] == column);
    }
  }
}

bool BlockCholesky::Factor(std::span<const PoseBlock> blocks) {
  ORB360_CHECK(blocks.size() == source_block_.size(), blocks.size());
  blocks_.assign(row_.size(), PoseBlock::Zero());
  for (size_t b = 0; b < blocks.size(); ++b) {
    const Matrix6 block = blocks[b].topRows<6>();
    PoseBlock& to = blocks_[source_block_[b]];
    if (is_turned_[b]) {
      to.topRows<6>() = block.transpose();
    } else {
      to.topRows<6>() = block;
    }
  }
  const auto update = HWY_DYNAMIC_DISPATCH(UpdateColumns);
  for (size_t k = 0; k < pose_at_.size(); ++k) {
    const size_t diagonal = first_[k];
    const Matrix6 own = blocks_[diagonal].topRows<6>();
    const Eigen::LLT<Matrix6> factor(own.selfadjointView<Eigen::Lower>());
    if (factor.info() != Eigen::Success) return false;
    const Matrix6 inverse = factor.matrixL().solve(Matrix6::Identity());
    blocks_[diagonal].topRows<6>() = inverse;
    const size_t below = diagonal + 1;
    const size_t count = first_[k + 1] - below;
    for (size_t i = 0; i < count; ++i) {
      const Matrix6 block = blocks_[below + i].topRows<6>();
      blocks_[below + i].topRows<6>().noalias() = block.lazyProduct(inverse.transpose());
    }
    update(blocks_.data() + below, row_.data() + below, count, first_.data(), row_.data(),
           blocks_.data());
  }
  return true;
}

std::vector<PoseVector> BlockCholesky::Solve(std::span<const PoseVector> sums) const {
  const size_t count = pose_at_.size();
  std::vector<Vector6> values(count);  // by place
  for (size_t k = 0; k < count; ++k) values[k] = sums[pose_at_[k]].head<6>();
  for (size_t k = 0; k < count; ++k) {
    values[k] = blocks_[first_[k]].topRows<6>() * values[k].eval();
    for (size_t b = first_[k] + 1; b < first_[k + 1]; ++b) {
      values[row_[b]] -= blocks_[b].topRows<6>() * values[k];
    }
  }
  for (size_t k = count; k-- > 0;) {
    for (size_t b = first_[k] + 1; b < first_[k + 1]; ++b) {
      values[k] -= blocks_[b].topRows<6>().transpose() * values[row_[b]];
    }
    values[k] = blocks_[first_[k]].topRows<6>().transpose() * values[k].eval();
  }
  std::vector<PoseVector> solution(count, PoseVector::Zero());
  for (size_t k = 0; k < count; ++k) solution[pose_at_[k]].head<6>() = values[k];
  return solution;
}

}  // namespace orb360
#endif
