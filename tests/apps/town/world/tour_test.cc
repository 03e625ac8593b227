#include "apps/town/world/tour.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(PlanTour, WalksBetweenNeighboursWithoutTurningRound) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const int blocks = 1 + static_cast<int>(seed % 4);
    const std::vector<size_t> walk = PlanTour({4, 3, blocks}, Random(seed));
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
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const auto junctions = [&](const TourOptions& options) {
      const std::vector<size_t> walk = PlanTour(options, Random(seed));
      return std::set<size_t>(walk.begin(), walk.end()).size();
    };
    EXPECT_EQ(junctions({3, 3, 1}), 4U);
    EXPECT_EQ(junctions({3, 3, 2}), 6U);
    EXPECT_EQ(junctions({2, 3, 2}), 6U);
    EXPECT_EQ(junctions({3, 2, 2}), 6U);
    EXPECT_EQ(PlanTour({4, 4, 4}, Random(seed)).size(), 16U);
  }
}

TEST(PlanTour, AroundTwoBlocksRepeatsASideSoon) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<size_t> walk = PlanTour({3, 3, 2}, Random(seed));
    EXPECT_EQ(walk[4], walk[0]);
    EXPECT_EQ(walk[5], walk[1]);  // the same side once more
    EXPECT_EQ(walk[8], walk[2]);  // another one backwards
    EXPECT_EQ(walk[9], walk[1]);
  }
}

TEST(PlanTour, ComesBackInTheOppositeDirection) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<size_t> walk = PlanTour({4, 4, 4}, Random(seed));
    std::set<std::pair<size_t, size_t>> driven;
    for (size_t i = 0; i < walk.size(); ++i) driven.emplace(walk[i], walk[(i + 1) % walk.size()]);
    EXPECT_TRUE(std::any_of(driven.begin(), driven.end(), [&](const auto& leg) {
      return driven.contains({leg.second, leg.first});
    })) << seed;
  }
}

TEST(PlanOtherTours, CirclesEachUseALegThatTheTourDoesNot) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<size_t> tour = PlanTour({4, 3, 3}, Random(seed));
    const auto legs = [](const std::vector<size_t>& walk) {
      std::set<std::pair<size_t, size_t>> result;
      for (size_t i = 0; i < walk.size(); ++i) result.emplace(walk[i], walk[(i + 1) % walk.size()]);
      return result;
    };
    const auto used = legs(tour);
    const auto others = PlanOtherTours(tour, 4, 3, Random(seed));
    EXPECT_GE(others.size(), 3U);
    for (const std::vector<size_t>& other : others) {
      int unused = 0;
      for (const auto& [a, b] : legs(other)) {
        unused += used.contains({a, b}) ? 0 : 1;
        const int columns = std::abs(static_cast<int>(a % 4) - static_cast<int>(b % 4));
        const int rows = std::abs(static_cast<int>(a / 4) - static_cast<int>(b / 4));
        EXPECT_EQ(columns + rows, 1);
      }
      EXPECT_GE(unused, 1);
    }
  }
}

}  // namespace
}  // namespace orb360::town
