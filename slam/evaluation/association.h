#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace orb360 {

/// Indices of two elements that belong together.
struct IndexPair {
  size_t a = 0;
  size_t b = 0;
  bool operator==(const IndexPair&) const = default;
};

/// Pairs two lists of times (seconds, any order). Each time is in at most one pair, no pair is more
/// than `max_difference` apart, and closer pairs are made first. Sorted by the time in `a`.
std::vector<IndexPair> AssociateByTime(std::span<const double> a, std::span<const double> b,
                                       double max_difference);

}  // namespace orb360
