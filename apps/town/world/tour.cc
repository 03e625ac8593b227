#include "apps/town/world/tour.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

/// Returns the corners of the block whose lower left junction is (column, row).
std::vector<size_t> Circle(int columns, int column, int row, bool clockwise) {
  const auto node = [columns](int c, int r) { return static_cast<size_t>(r * columns + c); };
  std::vector<size_t> circle = {node(column, row), node(column + 1, row), node(column + 1, row + 1),
                                node(column, row + 1)};
  if (clockwise) std::reverse(circle.begin(), circle.end());
  return circle;
}

/// Returns true if a closed walk turns back somewhere.
bool TurnsRound(const std::vector<size_t>& walk) {
  const size_t n = walk.size();
  for (size_t i = 0; i < n; ++i) {
    if (walk[i] == walk[(i + 2) % n]) return true;
  }
  return false;
}

/// Returns the pairs of neighbouring junctions of a closed walk, in driving order.
std::set<std::pair<size_t, size_t>> LegsOf(const std::vector<size_t>& walk) {
  const size_t n = walk.size();
  std::set<std::pair<size_t, size_t>> legs;
  for (size_t i = 0; i < n; ++i) legs.emplace(walk[i], walk[(i + 1) % n]);
  return legs;
}

/// Returns true if a closed walk uses some street in both directions.
bool ComesBack(const std::vector<size_t>& walk) {
  const std::set<std::pair<size_t, size_t>> legs = LegsOf(walk);
  return std::any_of(legs.begin(), legs.end(), [&](const auto& leg) {
    return legs.contains({leg.second, leg.first});
  });
}

/// Returns a walk around two neighbouring blocks PQRS and QXYR that soon repeats a side in the same
/// direction (PQ) and comes back along one in the opposite direction (QR, RQ).
std::vector<size_t> CircleTwoBlocks(const TourOptions& options, Random& random) {
  const int columns = options.columns;
  const int rows = options.rows;
  const bool side_by_side = columns > 2 && (rows == 2 || random.Chance(0.5));
  // The walk is counter-clockwise in both cases: when x and y are exchanged, it is mirrored and
  // begins elsewhere.
  const int column = random.Int(side_by_side ? columns - 2 : columns - 1);
  const int row = random.Int(side_by_side ? rows - 1 : rows - 2);
  const auto node = [&](int along, int across) {
    const int c = side_by_side ? column + along : column + 1 - across;
    const int r = side_by_side ? row + across : row + along;
    return static_cast<size_t>(r * columns + c);
  };
  const size_t p = node(0, 0), q = node(1, 0), x = node(2, 0);
  const size_t s = node(0, 1), r = node(1, 1), y = node(2, 1);
  return {p, q, r, s, p, q, x, y, r, q, x, y, r, s};
}

/// Returns circles around blocks, each entered at a junction of the previous walk.
std::vector<size_t> CircleBlocks(const TourOptions& options, Random random) {
  const int block_columns = options.columns - 1;
  const int block_rows = options.rows - 1;
  const bool clockwise = random.Chance(0.5);
  std::vector<bool> circled(static_cast<size_t>(block_columns) * static_cast<size_t>(block_rows),
                            false);
  const auto take = [&](int column, int row) {
    circled[static_cast<size_t>(row * block_columns + column)] = true;
    return Circle(options.columns, column, row, clockwise);
  };
  std::vector<size_t> walk = take(random.Int(block_columns), random.Int(block_rows));
  constexpr int kTries = 2000;
  int blocks = 1;
  for (int i = 0; i < kTries && blocks < options.blocks; ++i) {
    const int column = random.Int(block_columns);
    const int row = random.Int(block_rows);
    const size_t position = static_cast<size_t>(random.Int(static_cast<int>(walk.size())));
    if (circled[static_cast<size_t>(row * block_columns + column)]) continue;
    std::vector<size_t> circle = Circle(options.columns, column, row, clockwise);
    const auto entry = std::find(circle.begin(), circle.end(), walk[position]);
    if (entry == circle.end()) continue;
    // Replaces ... P ... by ... P, round the block, P ...
    std::rotate(circle.begin(), entry, circle.end());
    std::vector<size_t> longer = walk;
    longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(position), circle.begin(),
                  circle.end());
    if (TurnsRound(longer)) continue;
    walk = std::move(longer);
    take(column, row);
    ++blocks;
  }
  return walk;
}

}  // namespace

std::vector<size_t> PlanTour(const TourOptions& options, Random random) {
  ORB360_CHECK(options.columns >= 2 && options.rows >= 2 && options.blocks >= 1, options.columns,
               options.rows, options.blocks);
  if (options.blocks == 1) return CircleBlocks(options, random);
  if (options.blocks == 2 && options.columns * options.rows > 4)
    return CircleTwoBlocks(options, random);
  constexpr uint64_t kTries = 200;
  std::vector<size_t> walk;
  for (uint64_t i = 0; i < kTries && !ComesBack(walk); ++i)
    walk = CircleBlocks(options, random.Fork(i));
  return walk;
}

std::vector<std::vector<size_t>> PlanOtherTours(const std::vector<size_t>& tour, int columns,
                                                int rows, Random random) {
  const std::set<std::pair<size_t, size_t>> used = LegsOf(tour);
  std::set<std::vector<size_t>> tours;
  const int tries = 2 * (columns - 1) * (rows - 1);
  for (int i = 0; i < tries; ++i) {
    const int width = 1 + random.Int(std::min(2, columns - 1));
    const int height = 1 + random.Int(std::min(2, rows - 1));
    const int column = random.Int(columns - width);
    const int row = random.Int(rows - height);
    const bool clockwise = random.Chance(0.5);
    std::vector<size_t> circle;
    const auto add = [&](int c, int r) {
      circle.push_back(static_cast<size_t>((row + r) * columns + column + c));
    };
    for (int k = 0; k < width; ++k) add(k, 0);
    for (int k = 0; k < height; ++k) add(width, k);
    for (int k = width; k > 0; --k) add(k, height);
    for (int k = height; k > 0; --k) add(0, k);
    if (clockwise) std::reverse(circle.begin(), circle.end());
    const std::set<std::pair<size_t, size_t>> legs = LegsOf(circle);
    if (!std::includes(used.begin(), used.end(), legs.begin(), legs.end())) tours.insert(circle);
  }
  return {tours.begin(), tours.end()};
}

}  // namespace orb360::town
