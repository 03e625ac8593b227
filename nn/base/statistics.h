#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <ranges>

#include <orb360/nn/base/check.h>

namespace orb360 {

/// Returns the value that sorting would put at index `rank`, in linear time. The order of the
/// values changes. Contract: `rank` is less than the number of values; none of them is NaN.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> OrderStatistic(Values&& values, std::size_t rank) {
  ORB360_CHECK(rank < std::ranges::size(values), rank, std::ranges::size(values));
  const auto at = std::ranges::begin(values) + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(values, at);
  return *at;
}

/// Returns the median, which is the upper one of the two values in the middle where their number is
/// even, so that it is always one of the values. The order of the values changes. Contract: there
/// is a value, and none is NaN.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> Median(Values&& values) {
  return OrderStatistic(values, std::ranges::size(values) / 2);
}

/// Returns the quantile by the method of the nearest rank: the least value that at least the given
/// fraction of the values does not exceed. For a fraction of 0.5 that is the lower one of the two
/// values in the middle where their number is even. The order of the values changes. Contract:
/// 0 <= `fraction` <= 1; there is a value, and none is NaN.
template <std::ranges::random_access_range Values>
std::ranges::range_value_t<Values> NearestRankQuantile(Values&& values, double fraction) {
  ORB360_CHECK(fraction >= 0 && fraction <= 1, fraction);
  const double count = static_cast<double>(std::ranges::size(values));
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * count));
  return OrderStatistic(values, std::max<std::size_t>(rank, 1) - 1);
}

}  // namespace orb360
