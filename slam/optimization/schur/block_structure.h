#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace orb360 {

/// Which blocks of a symmetric block matrix are not zero: its lower triangle in compressed rows.
struct BlockStructure {
  std::vector<size_t> first = {0};  ///< Block by row, and the end.
  std::vector<int> column;  ///< By block; they increase along a row, the last is on the diagonal.

  size_t num_rows() const { return first.size() - 1; }
};

/// Sorts indices, or pairs of them, and removes duplicates.
template <typename Index>
void SortUnique(std::vector<Index>* indices) {
  std::sort(indices->begin(), indices->end());
  indices->erase(std::unique(indices->begin(), indices->end()), indices->end());
}

}  // namespace orb360
