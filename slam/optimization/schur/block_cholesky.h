#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/optimization/schur/block_structure.h"
#include "slam/optimization/schur/padded_block.h"

namespace orb360 {

/// Sparse Cholesky factorization L L^T of a symmetric matrix of kSize x kSize blocks, right-looking
/// by panels of columns, with vector instructions (George, Liu, Computer Solution of Large Sparse
/// Positive Definite Systems, 1981). The elimination order is approximate minimum degree (Amestoy,
/// Davis, Duff, 1996). It is defined for kSize 6 (poses) and 7 (similarities).
template <int kSize>
class BlockCholesky {
 public:
  using Block = PaddedBlock<kSize>;

  /// Chooses the elimination order and finds which blocks of L are not zero.
  explicit BlockCholesky(const BlockStructure& structure);

  /// Factors the matrix with the blocks that the structure lists. False where it is not positive
  /// definite to rounding.
  bool Factor(std::span<const Block> blocks);

  /// Solves L L^T x = rhs; all vectors by row of the matrix. Contract: Factor has succeeded.
  std::vector<PaddedVector> Solve(std::span<const PaddedVector> rhs) const;

  /// Number of blocks of L that are stored.
  size_t size() const { return row_.size(); }

 private:
  void FormPanels(std::vector<std::vector<int>>* below);
  bool FactorColumn(size_t column);

  // L has the rows and columns of the matrix in elimination order.
  std::vector<int> matrix_row_;       ///< By row of L.
  std::vector<size_t> factor_block_;  ///< By block of the matrix: its block of L.
  /// By block of the matrix: whether L contains its transpose.
  std::vector<uint8_t> is_transposed_;
  // L by columns. The rows of a column's blocks increase; the first is on the diagonal.
  std::vector<size_t> first_ = {0};
  std::vector<int> row_;
  // A panel is a range of columns with blocks in the same rows, some of which may be zero. Its
  // columns update each later column together, so that a later column is loaded once for all.
  std::vector<size_t> first_column_;  ///< By panel, and the end.
  std::vector<Block> blocks_;         ///< Diagonal blocks are stored inverted.
};

}  // namespace orb360
