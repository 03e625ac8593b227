#include "apps/town/world/tour.h"

#include <algorithm>
#include <array>

#include "slam/check.h"

namespace orb360::town {
namespace {

/// The corners of the block whose lower left junction is (column, row).
std::vector<size_t> Circle(int columns, int column, int row, bool clockwise) {
  const auto node = [columns](int c, int r) { return static_cast<size_t>(r * columns + c); };
  std::vector<size_t> circle = {node(column, row), node(column + 1, row), node(column + 1, row + 1),
                                node(column, row + 1)};
  if (clockwise) std::reverse(circle.begin(), circle.end());
  return circle;
}

/// Whether a closed walk turns round somewhere.
bool TurnsRound(const std::vector<size_t>& walk) {
  const size_t n = walk.size();
  for (size_t i = 0; i < n; ++i) {
    if (walk[i] == walk[(i + 2) % n]) return true;
  }
  return false;
}

}  // namespace

std::vector<size_t> PlanTour(const TourOptions& options, Random random) {
  const int block_columns = options.columns - 1;
  const int block_rows = options.rows - 1;
  ORB360_CHECK(block_columns >= 1 && block_rows >= 1 && options.blocks >= 1, options.columns,
               options.rows, options.blocks);
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
    // ... P ... becomes ... P, round the block, P ...
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

}  // namespace orb360::town
