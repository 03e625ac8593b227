#include "slam/io/octree/octree_levels.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace orb360 {
namespace {

/// The first `level` digits of a code.
std::uint64_t CubeOf(std::uint64_t code, int level) { return code >> 3 * (kMortonBits - level); }

bool Precedes(const SortedPoint& a, const SortedPoint& b) {
  return std::pair(a.code, a.index) < std::pair(b.code, b.index);
}

}  // namespace

void OctreeLevels::Add(const SortedPoint& point) {
  const int common = last_code_ ? CommonDigits(*last_code_, point.code) : kMortonBits;
  last_code_ = point.code;
  for (int digits = kMortonBits; digits > std::max(common, kOctreeCellBits - 1); --digits) {
    CloseCell(digits);
  }
  for (int level = kOctreeMaxLevel; level > common; --level) CloseNode(level);
  // Points with the same code are in one cell of the least width.
  std::optional<SortedPoint>& best = best_[kMortonBits];
  if (!best) {
    best = point;
  } else if (point.confidence > best->confidence) {
    Place(*std::exchange(best, point), kOctreeMaxLevel);
  } else {
    Place(point, kOctreeMaxLevel);
  }
}

void OctreeLevels::CloseCell(int digits) {
  if (!best_[digits]) return;
  const SortedPoint point = *std::exchange(best_[digits], std::nullopt);
  const int level = digits - kOctreeCellBits;
  if (level == 0) {
    Place(point, 0);
    return;
  }
  std::optional<SortedPoint>& best = best_[digits - 1];
  if (!best) {
    best = point;
  } else if (point.confidence > best->confidence) {
    Place(*std::exchange(best, point), level);
  } else {
    Place(point, level);
  }
}

void OctreeLevels::Place(const SortedPoint& point, int level) {
  for (int above = 0; above <= level; ++above) {
    std::optional<Open>& open = open_[above];
    if (!open) open.emplace(Open{{above, CubeOf(point.code, above), 0, {}}, {}, 0});
  }
  open_[level]->node.points.push_back(point);
}

void OctreeLevels::CloseNode(int level) {
  if (!open_[level]) return;
  Open open = *std::exchange(open_[level], std::nullopt);
  open.num_points += open.node.points.size();
  if (open.num_points <= kOctreeLeafPoints) {
    for (Node& leaf : open.leaves)
      std::ranges::move(leaf.points, std::back_inserter(open.node.points));
    open.leaves.clear();
    open.node.children = 0;
  }
  std::ranges::sort(open.node.points, Precedes);
  std::ranges::for_each(open.leaves, take_);
  if (level == 0) {
    take_(open.node);
    return;
  }
  Open& parent = *open_[level - 1];
  parent.num_points += open.num_points;
  parent.node.children =
      static_cast<std::uint8_t>(parent.node.children | 1U << (open.node.code & 7));
  if (open.num_points <= kOctreeLeafPoints) {
    parent.leaves.push_back(std::move(open.node));
  } else {
    take_(open.node);
  }
}

void OctreeLevels::Finish() {
  for (int digits = kMortonBits; digits >= kOctreeCellBits; --digits) CloseCell(digits);
  for (int level = kOctreeMaxLevel; level >= 0; --level) CloseNode(level);
}

}  // namespace orb360
