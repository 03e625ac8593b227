#include "apps/town/world/tour.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(PlanTour, WalksBetweenNeighboursWithoutTurningRound) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<size_t> walk = PlanTour({4, 3, 4}, Random(seed));
    const size_t n = walk.size();
    for (size_t i = 0; i < n; ++i) {
      const int columns =
          std::abs(static_cast<int>(walk[i] % 4) - static_cast<int>(walk[(i + 1) % n] % 4));
      const int rows =
          std::abs(static_cast<int>(walk[i] / 4) - static_cast<int>(walk[(i + 1) % n] / 4));
      EXPECT_EQ(columns + rows, 1);
      EXPECT_NE(walk[i], walk[(i + 2) % n]);
    }
  }
}

TEST(PlanTour, CirclesTheBlocksAskedFor) {
  EXPECT_EQ(PlanTour({3, 3, 1}, Random(1)).size(), 4U);
  for (uint64_t seed = 0; seed < 50; ++seed)
    EXPECT_EQ(PlanTour({3, 3, 2}, Random(seed)).size(), 8U) << seed;
}

TEST(PlanTour, ComesBackInTheOppositeDirectionMostTimes) {
  int opposite = 0;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<size_t> walk = PlanTour({4, 4, 4}, Random(seed));
    std::set<std::pair<size_t, size_t>> driven;
    for (size_t i = 0; i < walk.size(); ++i) driven.emplace(walk[i], walk[(i + 1) % walk.size()]);
    opposite += std::any_of(driven.begin(), driven.end(),
                            [&](const auto& leg) {
                              return driven.contains({leg.second, leg.first});
                            })
                    ? 1
                    : 0;
  }
  EXPECT_GT(opposite, 40);
}

}  // namespace
}  // namespace orb360::town
