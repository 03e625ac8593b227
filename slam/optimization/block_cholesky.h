#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/optimization/normal_equations.h"

namespace orb360 {

/// Cholesky factorization L L^T of a bundle's reduced system: sparse, in blocks of six unknowns,
/// with vector instructions. (George and Liu, Computer Solution of Large Sparse Positive Definite
/// Systems, 1981; the order of elimination is approximate minimum degree.)
class BlockCholesky {
 public:
  /// Finds an order of elimination, and which blocks of L are not zero.
  explicit BlockCholesky(const ReducedStructure& structure);

  /// `blocks`: as the structure lists them. False where the matrix is not positive definite to
  /// rounding.
  bool Factor(std::span<const PoseBlock> blocks);

  /// By row. Contract: Factor has succeeded.
  std::vector<PoseVector> Solve(std::span<const PoseVector> sums) const;

  /// Blocks of L that are kept.
  size_t size() const { return row_.size(); }

 private:
  void FormPanels(std::vector<std::vector<int>>* below);
  bool FactorColumn(size_t column);

  // Rows of the matrix are taken in the order of their places.
  std::vector<int> row_at_;
  std::vector<size_t> source_block_;  // by block of the matrix: its block of L
  std::vector<uint8_t> is_turned_;    // and whether it is transposed there
  // L by columns: the rows (places) of a column's blocks rise, the first is on the diagonal.
  std::vector<size_t> first_ = {0};
  std::vector<int> row_;
  // Panels: neighbouring columns with blocks in the same rows, some of which may be zero. They are
  // taken off later columns together, so that each of these is fetched once for all of them.
  std::vector<size_t> first_column_;  // by panel, and the end
  std::vector<PoseBlock> blocks_;     // on the diagonal the inverse
};

}  // namespace orb360
