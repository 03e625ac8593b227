#include "slam/optimization/schur/block_cholesky.h"

#include <algorithm>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/optimization/schur/block_cholesky.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// target -= sum over k of A_k B_k^T, where A_k = columns[k][a] and B_k = columns[k][b]. One vector
// holds some or all rows of a column of the target; all columns stay in registers.
template <int kSize>
void SubtractProducts(const PaddedBlock<kSize>* const* columns, size_t num_columns, size_t a,
                      size_t b, PaddedBlock<kSize>* target) {
  static_assert(kSize == 6 || kSize == 7);
  constexpr bool kHasSeventh = kSize == 7;
  const hn::CappedTag<double, kPaddedRows> d;
  for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
    const auto column = [&](size_t c) HWY_ATTR { return target->data() + c * kPaddedRows + i; };
    auto rest0 = hn::LoadU(d, column(0)), rest1 = hn::LoadU(d, column(1));
    auto rest2 = hn::LoadU(d, column(2)), rest3 = hn::LoadU(d, column(3));
    auto rest4 = hn::LoadU(d, column(4)), rest5 = hn::LoadU(d, column(5));
    auto rest6 = kHasSeventh ? hn::LoadU(d, column(kSize - 1)) : hn::Zero(d);
    for (size_t k = 0; k < num_columns; ++k) {
      const double* a_column = columns[k][a].data() + i;
      const double* b_column = columns[k][b].data();
      for (size_t m = 0; m < kSize; ++m, a_column += kPaddedRows, b_column += kPaddedRows) {
        const auto rows = hn::LoadU(d, a_column);
        rest0 = hn::NegMulAdd(rows, hn::Set(d, b_column[0]), rest0);
        rest1 = hn::NegMulAdd(rows, hn::Set(d, b_column[1]), rest1);
        rest2 = hn::NegMulAdd(rows, hn::Set(d, b_column[2]), rest2);
        rest3 = hn::NegMulAdd(rows, hn::Set(d, b_column[3]), rest3);
        rest4 = hn::NegMulAdd(rows, hn::Set(d, b_column[4]), rest4);
        rest5 = hn::NegMulAdd(rows, hn::Set(d, b_column[5]), rest5);
        if constexpr (kHasSeventh) rest6 = hn::NegMulAdd(rows, hn::Set(d, b_column[6]), rest6);
      }
    }
    hn::StoreU(rest0, d, column(0));
    hn::StoreU(rest1, d, column(1));
    hn::StoreU(rest2, d, column(2));
    hn::StoreU(rest3, d, column(3));
    hn::StoreU(rest4, d, column(4));
    hn::StoreU(rest5, d, column(5));
    if constexpr (kHasSeventh) hn::StoreU(rest6, d, column(6));
  }
}

// Subtracts what columns of L, all with blocks in the rows `rows`, contribute to the columns with
// the numbers of the first `num_targets` of these rows.
template <int kSize>
void UpdateColumns(const PaddedBlock<kSize>* const* columns, size_t num_columns,
                   std::span<const int> rows, size_t num_targets, const size_t* first,
                   const int* row_of_block, PaddedBlock<kSize>* blocks) {
  for (size_t j = 0; j < num_targets; ++j) {
    size_t index = first[rows[j]];
    for (size_t i = j; i < rows.size(); ++i) {
      while (row_of_block[index] != rows[i]) ++index;
      SubtractProducts(columns, num_columns, i, j, blocks + index);
    }
  }
}

void UpdateColumns6(const PaddedBlock<6>* const* columns, size_t num_columns,
                    std::span<const int> rows, size_t num_targets, const size_t* first,
                    const int* row_of_block, PaddedBlock<6>* blocks) {
  UpdateColumns<6>(columns, num_columns, rows, num_targets, first, row_of_block, blocks);
}

void UpdateColumns7(const PaddedBlock<7>* const* columns, size_t num_columns,
                    std::span<const int> rows, size_t num_targets, const size_t* first,
                    const int* row_of_block, PaddedBlock<7>* blocks) {
  UpdateColumns<7>(columns, num_columns, rows, num_targets, first, row_of_block, blocks);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360 {
namespace {

HWY_EXPORT(UpdateColumns6);
HWY_EXPORT(UpdateColumns7);

template <int kSize>
auto ChooseUpdateColumns() {
  if constexpr (kSize == 6) {
    return HWY_DYNAMIC_DISPATCH(UpdateColumns6);
  } else {
    return HWY_DYNAMIC_DISPATCH(UpdateColumns7);
  }
}

std::vector<int> EliminationOrder(const BlockStructure& structure) {
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

template <int kSize>
BlockCholesky<kSize>::BlockCholesky(const BlockStructure& structure)
    : matrix_row_(EliminationOrder(structure)) {
  const int count = static_cast<int>(structure.num_rows());
  std::vector<int> factor_row(count);  // inverse of matrix_row_
  for (int k = 0; k < count; ++k) factor_row[matrix_row_[k]] = k;
  std::vector<std::vector<int>> below(count);  // by column: rows of the blocks below the diagonal
  for (int i = 0; i < count; ++i) {
    for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(factor_row[i], factor_row[structure.column[b]]);
      if (row != column) below[column].push_back(row);
    }
  }
  for (std::vector<int>& rows : below) {
    SortUnique(&rows);
    // The elimination tree: a column's parent is the row of its first block below the diagonal, and
    // has blocks in all further rows of the column.
    if (rows.empty()) continue;
    std::vector<int>& parent = below[rows.front()];
    parent.insert(parent.end(), rows.begin() + 1, rows.end());
  }
  FormPanels(&below);
  for (int k = 0; k < count; ++k) {
    row_.push_back(k);
    row_.insert(row_.end(), below[k].begin(), below[k].end());
    first_.push_back(row_.size());
  }
  for (int i = 0; i < count; ++i) {
    for (size_t b = structure.first[i]; b < structure.first[i + 1]; ++b) {
      const auto [column, row] = std::minmax(factor_row[i], factor_row[structure.column[b]]);
      const auto begin = row_.begin() + static_cast<std::ptrdiff_t>(first_[column]);
      const auto end = row_.begin() + static_cast<std::ptrdiff_t>(first_[column + 1]);
      factor_block_.push_back(
          static_cast<size_t>(std::lower_bound(begin, end, row) - row_.begin()));
      is_transposed_.push_back(factor_row[i] == column);
    }
  }
}

// Goes from the last column to the first, since a column is filled up to the rows of the next.
template <int kSize>
void BlockCholesky<kSize>::FormPanels(std::vector<std::vector<int>>* below) {
  constexpr int kMaxColumns = 8;   // their blocks stay in the second-level cache
  constexpr size_t kMaxZeros = 8;  // at most one zero for this many blocks of a column
  const auto count = static_cast<int>(below->size());
  int end = count;
  first_column_ = {below->size()};
  for (int k = count - 1; k > 0; --k) {
    std::vector<int>& rows = (*below)[k - 1];
    const std::vector<int>& next = (*below)[k];
    const bool is_child_of_next = !rows.empty() && rows.front() == k;
    const size_t num_zeros = next.size() + 1 - rows.size();
    if (is_child_of_next && num_zeros <= rows.size() / kMaxZeros && end - k < kMaxColumns) {
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

template <int kSize>
bool BlockCholesky<kSize>::Factor(std::span<const Block> blocks) {
  ORB360_CHECK(blocks.size() == factor_block_.size(), blocks.size());
  blocks_.assign(row_.size(), Block::Zero());
  for (size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::Matrix<double, kSize, kSize> block = blocks[b].template topRows<kSize>();
    Block& target = blocks_[factor_block_[b]];
    if (is_transposed_[b]) {
      target.template topRows<kSize>() = block.transpose();
    } else {
      target.template topRows<kSize>() = block;
    }
  }
  const auto update = ChooseUpdateColumns<kSize>();
  std::vector<const Block*> columns;
  for (size_t p = 0; p + 1 < first_column_.size(); ++p) {
    const size_t end = first_column_[p + 1];
    // The rows below the panel, in which all its columns have blocks.
    const std::span<const int> common(row_.data() + first_[end - 1] + 1, row_.data() + first_[end]);
    columns.clear();
    for (size_t k = first_column_[p]; k < end; ++k) {
      if (!FactorColumn(k)) return false;
      const Block* below = blocks_.data() + first_[k] + 1;
      const size_t num_later = end - 1 - k;
      update(&below, 1, {row_.data() + first_[k] + 1, row_.data() + first_[k + 1]}, num_later,
             first_.data(), row_.data(), blocks_.data());
      columns.push_back(below + num_later);
    }
    update(columns.data(), columns.size(), common, common.size(), first_.data(), row_.data(),
           blocks_.data());
  }
  return true;
}

template <int kSize>
bool BlockCholesky<kSize>::FactorColumn(size_t k) {
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  const size_t diagonal = first_[k];
  const Matrix pivot = blocks_[diagonal].template topRows<kSize>();
  const Eigen::LLT<Matrix> factor(pivot.template selfadjointView<Eigen::Lower>());
  if (factor.info() != Eigen::Success) return false;
  const Matrix inverse = factor.matrixL().solve(Matrix::Identity());
  blocks_[diagonal].template topRows<kSize>() = inverse;
  for (size_t b = diagonal + 1; b < first_[k + 1]; ++b) {
    const Matrix block = blocks_[b].template topRows<kSize>();
    blocks_[b].template topRows<kSize>().noalias() = block.lazyProduct(inverse.transpose());
  }
  return true;
}

template <int kSize>
std::vector<PaddedVector> BlockCholesky<kSize>::Solve(std::span<const PaddedVector> rhs) const {
  const size_t count = matrix_row_.size();
  std::vector<Eigen::Matrix<double, kSize, 1>> x(count);  // by row of L
  for (size_t k = 0; k < count; ++k) x[k] = rhs[matrix_row_[k]].template head<kSize>();
  for (size_t k = 0; k < count; ++k) {
    x[k] = blocks_[first_[k]].template topRows<kSize>() * x[k].eval();
    for (size_t b = first_[k] + 1; b < first_[k + 1]; ++b) {
      x[row_[b]] -= blocks_[b].template topRows<kSize>() * x[k];
    }
  }
  for (size_t k = count; k-- > 0;) {
    for (size_t b = first_[k] + 1; b < first_[k + 1]; ++b) {
      x[k] -= blocks_[b].template topRows<kSize>().transpose() * x[row_[b]];
    }
    x[k] = blocks_[first_[k]].template topRows<kSize>().transpose() * x[k].eval();
  }
  std::vector<PaddedVector> solution(count, PaddedVector::Zero());
  for (size_t k = 0; k < count; ++k) solution[matrix_row_[k]].template head<kSize>() = x[k];
  return solution;
}

template class BlockCholesky<6>;
template class BlockCholesky<7>;

}  // namespace orb360
#endif
