#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "slam/io/octree/morton.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/point_sorter.h"

namespace orb360 {

/// Divides points, which come in the order of their codes, among the nodes of an octree.
///
/// A point belongs to the coarsest level on which it is the best one of its cell, where the cells
/// of a level are a 2^kOctreeCellBits-th of the side of its nodes, and the best is the most
/// confident point, the first of several. The best point of a cell is also that of the finer cell
/// which has it, so the points down to a level are one a cell. Equal digits of Morton codes are
/// common cells: while the points come, one cell of each width is open, and keeps the best point so
/// far. A cube with few points becomes a leaf with all of them. Memory: the open nodes on the path
/// from the root, and the leaves below each.
class OctreeLevels {
 public:
  struct Node {
    int level = 0;
    std::uint64_t code = 0;  ///< Of its cube: the first `level` digits of its points' codes.
    std::uint8_t children = 0;
    std::vector<SortedPoint> points;  ///< In the order of their codes.
  };

  /// `take` receives each node after its children.
  explicit OctreeLevels(std::function<void(const Node&)> take) : take_(std::move(take)) {}

  void Add(const SortedPoint& point);
  /// Closes all nodes. It is the last call.
  void Finish();

 private:
  /// A node of which more points may come, with its closed children that may still become a part of
  /// it.
  struct Open {
    Node node;
    std::vector<Node> leaves;
    std::uint64_t num_points = 0;  // with all below it
  };

  /// Passes the best point of the open cell of a width to the cell around it, whose former best it
  /// may replace. The lesser of both belongs to the level of the cells of this width.
  void CloseCell(int digits);
  void Place(const SortedPoint& point, int level);
  void CloseNode(int level);

  std::function<void(const Node&)> take_;
  /// By the number of digits that the points of a cell have in common.
  std::array<std::optional<SortedPoint>, kMortonBits + 1> best_;
  std::array<std::optional<Open>, kOctreeMaxLevel + 1> open_;  // by level
  std::optional<std::uint64_t> last_code_;
};

}  // namespace orb360
