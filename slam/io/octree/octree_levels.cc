#include "slam/io/octree/octree_levels.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "slam/io/octree/morton.h"

namespace orb360 {
namespace {

/// The first `level` digits of a code.
std::uint64_t CubeOf(std::uint64_t code, int level) { return code >> 3 * (kMortonBits - level); }

}  // namespace

void OctreeLevels::Add(const SortedPoint& point) {
  const int common = last_code_ ? CommonDigits(*last_code_, point.code) : -1;
  last_code_ = point.code;
  for (int level = kOctreeMaxLevel; level > std::max(common, 0); --level) Close(level);
  // It is the first of its cell on all levels whose cells have more digits than are common.
  const int level = std::clamp(common + 1 - kOctreeCellBits, 0, kOctreeMaxLevel);
  for (int above = 0; above <= level; ++above) {
    std::optional<Open>& open = open_[above];
    if (!open) open.emplace(Open{{above, CubeOf(point.code, above), 0, {}}, {}, 0});
  }
  open_[level]->node.points.push_back(point);
}

void OctreeLevels::Close(int level) {
  if (!open_[level]) return;
  Open open = *std::exchange(open_[level], std::nullopt);
  open.num_points += open.node.points.size();
  if (open.num_points <= kOctreeLeafPoints) {
    for (Node& leaf : open.leaves)
      std::ranges::move(leaf.points, std::back_inserter(open.node.points));
    open.leaves.clear();
    open.node.children = 0;
    std::ranges::sort(open.node.points, {},
                      [](const SortedPoint& point) { return std::pair(point.code, point.index); });
  }
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
  for (int level = kOctreeMaxLevel; level >= 0; --level) Close(level);
}

}  // namespace orb360
