#include "nn/base/statistics.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(OrderStatistic, IsWhatSortingPutsThere) {
  std::mt19937 random(1);
  for (const std::size_t count : {1u, 2u, 7u, 100u}) {
    std::vector<int> values(count);
    for (int& value : values) value = static_cast<int>(random() % 20);  // with repetitions
    std::vector<int> sorted = values;
    std::ranges::sort(sorted);
    for (std::size_t rank = 0; rank < count; ++rank) {
      EXPECT_EQ(OrderStatistic(values, rank), sorted[rank]) << count;
    }
  }
}

TEST(OrderStatistic, RefusesARankBeyondTheValues) {
  std::vector<double> values = {1, 2};
  EXPECT_THROW(OrderStatistic(values, 2), ContractError);
}

TEST(Median, IsTheMiddleValueAndTheUpperOneOfTwo) {
  EXPECT_EQ(Median(std::vector<double>{3.5}), 3.5);
  EXPECT_EQ(Median(std::vector<double>{4, 1, 3}), 3);
  EXPECT_EQ(Median(std::vector<double>{4, 1}), 4);
  EXPECT_EQ(Median(std::vector<double>{8, 1, 3, 2}), 3);
}

TEST(Median, TakesAPartOfABuffer) {
  std::vector<std::uint16_t> values = {9, 9, 1, 5, 3, 0};
  EXPECT_EQ(Median(std::span(values).subspan(2, 3)), 3);
  EXPECT_EQ(values.front(), 9);
  EXPECT_EQ(values.back(), 0);
}

TEST(Median, RefusesNoValues) { EXPECT_THROW(Median(std::vector<double>{}), ContractError); }

TEST(NearestRankQuantile, IsTheLeastValueThatEnoughValuesDoNotExceed) {
  std::mt19937 random(2);
  for (const std::size_t count : {1u, 2u, 19u, 20u, 100u}) {
    std::vector<double> values(count);
    for (double& value : values) value = static_cast<double>(random() % 50);
    for (const double fraction : {0.0, 0.05, 0.5, 0.9, 0.95, 1.0}) {
      const double quantile = NearestRankQuantile(values, fraction);
      const auto covers = [&](double limit) {
        const auto below = std::ranges::count_if(values, [&](double v) { return v <= limit; });
        return static_cast<double>(below) >= fraction * static_cast<double>(count);
      };
      EXPECT_TRUE(covers(quantile)) << count << ' ' << fraction;
      for (const double value : values) {
        EXPECT_TRUE(value >= quantile || !covers(value)) << count << ' ' << fraction;
      }
      EXPECT_GT(std::ranges::count(values, quantile), 0);
    }
  }
}

TEST(NearestRankQuantile, OfHalfIsTheLowerOneOfTwoValuesInTheMiddle) {
  EXPECT_EQ(NearestRankQuantile(std::vector<double>{4, 1}, 0.5), 1);
  EXPECT_EQ(NearestRankQuantile(std::vector<double>{1, 2, 3, 4}, 0.5), 2);
}

TEST(NearestRankQuantile, RefusesAFractionOutsideZeroToOne) {
  EXPECT_THROW(NearestRankQuantile(std::vector<double>{1}, 1.1), ContractError);
}

}  // namespace
}  // namespace orb360
