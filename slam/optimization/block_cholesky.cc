#include "slam/optimization/block_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <span>

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

// to -= the sum of a_k b_k^T, where a_k and b_k are the blocks number `a` and `b` of each column.
void SubtractProducts(const PoseBlock* const* columns, size_t num_columns, size_t a, size_t b,
                      PoseBlock* to) {
  const D d;
  for (size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    const auto target = [&](size_t c) HWY_ATTR { return to->data() + c * kPoseRows + i; };
    auto left0 = hn::LoadU(d, target(0)), left1 = hn::LoadU(d, target(1));
    auto left2 = hn::LoadU(d, target(2)), left3 = hn::LoadU(d, target(3));
    auto left4 = hn::LoadU(d, target(4)), left5 = hn::LoadU(d, target(5));
    for (size_t k = 0; k < num_columns; ++k) {
      const double* rows = columns[k][a].data() + i;
      const double* factors = columns[k][b].data();
      for (size_t m = 0; m < kRows; ++m, rows += kPoseRows, factors += kPoseRows) {
        const auto row = hn::LoadU(d, rows);
        left0 = hn::NegMulAdd(row, hn::Set(d, factors[0]), left0);
        left1 = hn::NegMulAdd(row, hn::Set(d, factors[1]), left1);
        left2 = hn::NegMulAdd(row, hn::Set(d, factors[2]), left2);
        left3 = hn::NegMulAdd(row, hn::Set(d, factors[3]), left3);
        left4 = hn::NegMulAdd(row, hn::Set(d, factors[4]), left4);
        left5 = hn::NegMulAdd(row, hn::Set(d, factors[5]), left5);
      }
    }
    hn::StoreU(left0, d, target(0));
    hn::StoreU(left1, d, target(1));
    hn::StoreU(left2, d, target(2));
    hn::StoreU(left3, d, target(3));
    hn::StoreU(left4, d, target(4));
    hn::StoreU(left5, d, target(5));
  }
}

// What some columns of L, all with blocks in the rows `rows`, take off the columns of the first
// `num_targets` of these rows.
void UpdateColumns(const PoseBlock* const* columns, size_t num_columns, std::span<const int> rows,
                   size_t num_targets, const size_t* first, const int* row_of, PoseBlock* blocks) {
  for (size_t j = 0; j < num_targets; ++j) {
    size_t at = first[rows[j]];
    for (size_t i = j; i < rows.size(); ++i) {
      while (row_of[at] != rows[i]) ++at;
      SubtractProducts(columns, num_columns, i, j, blocks + at);
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

// Rows in the order of their elimination.
std::vector<int> OrderRows(const ReducedStructure& structure) {
  const int count = static_cast<int>(structure.num_rows());
  std::vector<Eigen::Triplet<int>> entries;
  for (int i = 0; i < count; ++i) {
    for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
      entries.emplace_back(i, structure.column[b], 1);
      entries.emplace_back(structure.column[b], i, 1);
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

BlockCholesky::BlockCholesky(const ReducedStructure& structure) : row_at_(OrderRows(structure)) {
  const int count = static_cast<int>(structure.num_rows());
  std::vector<int> place_of(count);
  for (int place = 0; place < count; ++place) place_of[row_at_[place]] = place;
  std::vector<std::vector<int>> below(count);  // by column: rows of blocks that are not zero
  for (int i = 0; i < count; ++i) {
    for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(place_of[i], place_of[structure.column[b]]);
      if (row != column) below[column].push_back(row);
    }
  }
  for (std::vector<int>& rows : below) {
    std::ranges::sort(rows);
    rows.erase(std::ranges::unique(rows).begin(), rows.end());
    // Where a column has blocks, the first of its rows' column gets some as well.
    if (rows.empty()) continue;
    std::vector<int>& next = below[rows.front()];
    next.insert(next.end(), rows.begin() + 1, rows.end());
  }
  FormPanels(&below);
  for (int k = 0; k < count; ++k) {
    row_.push_back(k);
    row_.insert(row_.end(), below[k].begin(), below[k].end());
    first_.push_back(row_.size());
  }
  for (int i = 0; i < count; ++i) {
    for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(place_of[i], place_of[structure.column[b]]);
      const auto begin = row_.begin() + static_cast<std::ptrdiff_t>(first_[column]);
      const auto end = row_.begin() + static_cast<std::ptrdiff_t>(first_[column + 1]);
      source_block_.push_back(
          static_cast<size_t>(std::lower_bound(begin, end, row) - row_.begin()));
      is_turned_.push_back(place_of[i] == column);
    }
  }
}

// From the last column to the first, since what a column is filled up with is what the next has.
void BlockCholesky::FormPanels(std::vector<std::vector<int>>* below) {
  constexpr int kMaxColumns = 8;   // whose blocks stay in the second cache
  constexpr size_t kMaxZeros = 8;  // one in as many of a column's blocks
  const auto count = static_cast<int>(below->size());
  int end = count;
  first_column_ = {below->size()};
  for (int k = count - 1; k > 0; --k) {
    std::vector<int>& rows = (*below)[k - 1];
    const std::vector<int>& next = (*below)[k];
    const bool is_chain = !rows.empty() && rows.front() == k;
    const size_t zeros = next.size() + 1 - rows.size();
    if (is_chain && zeros <= rows.size() / kMaxZeros && end - k < kMaxColumns) {
      rows = next;
      rows.insert(rows.begin(), k);
    } else {
      first_column_.push_back(k);
      end = k;
    }
  }
  if (count > 0) first_column_.push_back(0);
  std::ranges::reverse(first_column_);
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
  std::vector<const PoseBlock*> columns;
  for (size_t p = 0; p + 1 < first_column_.size(); ++p) {
    const size_t end = first_column_[p + 1];
    // All columns of a panel have these blocks, behind those in rows of the panel itself.
    const std::span<const int> shared(row_.data() + first_[end - 1] + 1, row_.data() + first_[end]);
    columns.clear();
    for (size_t k = first_column_[p]; k < end; ++k) {
      if (!FactorColumn(k)) return false;
      const PoseBlock* below = blocks_.data() + first_[k] + 1;
      const size_t num_later = end - 1 - k;
      update(&below, 1, {row_.data() + first_[k] + 1, row_.data() + first_[k + 1]}, num_later,
             first_.data(), row_.data(), blocks_.data());
      columns.push_back(below + num_later);
    }
    update(columns.data(), columns.size(), shared, shared.size(), first_.data(), row_.data(),
           blocks_.data());
  }
  return true;
}

bool BlockCholesky::FactorColumn(size_t k) {
  const size_t diagonal = first_[k];
  const Matrix6 own = blocks_[diagonal].topRows<6>();
  const Eigen::LLT<Matrix6> factor(own.selfadjointView<Eigen::Lower>());
  if (factor.info() != Eigen::Success) return false;
  const Matrix6 inverse = factor.matrixL().solve(Matrix6::Identity());
  blocks_[diagonal].topRows<6>() = inverse;
  for (size_t b = diagonal + 1; b < first_[k + 1]; ++b) {
    const Matrix6 block = blocks_[b].topRows<6>();
    blocks_[b].topRows<6>().noalias() = block.lazyProduct(inverse.transpose());
  }
  return true;
}

std::vector<PoseVector> BlockCholesky::Solve(std::span<const PoseVector> sums) const {
  const size_t count = row_at_.size();
  std::vector<Vector6> values(count);  // by place
  for (size_t k = 0; k < count; ++k) values[k] = sums[row_at_[k]].head<6>();
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
  for (size_t k = 0; k < count; ++k) solution[row_at_[k]].head<6>() = values[k];
  return solution;
}

}  // namespace orb360
#endif
