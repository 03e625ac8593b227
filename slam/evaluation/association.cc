#include "slam/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace orb360 {
namespace {

/// Returns the indices of `times` in the order of time.
std::vector<size_t> SortedByTime(std::span<const double> times) {
  std::vector<size_t> order(times.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t i) { return times[i]; });
  return order;
}

}  // namespace

std::vector<IndexPair> AssociateByTime(std::span<const double> a, std::span<const double> b,
                                       double max_difference) {
  struct Candidate {
    double difference;
    IndexPair pair;
  };
  const std::vector<size_t> order_b = SortedByTime(b);
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < a.size(); ++i) {
    auto j = std::ranges::lower_bound(order_b, a[i] - max_difference, {},
                                      [&](size_t k) { return b[k]; });
    for (; j != order_b.end() && b[*j] <= a[i] + max_difference; ++j) {
      candidates.push_back({std::abs(a[i] - b[*j]), {i, *j}});
    }
  }
  std::ranges::sort(candidates, {}, [](const Candidate& c) {
    return std::tuple(c.difference, c.pair.a, c.pair.b);
  });

  std::vector<bool> used_a(a.size());
  std::vector<bool> used_b(b.size());
  std::vector<IndexPair> pairs;
  for (const Candidate& candidate : candidates) {
    const auto [i, j] = candidate.pair;
    if (used_a[i] || used_b[j]) continue;
    used_a[i] = used_b[j] = true;
    pairs.push_back(candidate.pair);
  }
  std::ranges::sort(pairs, {}, [&](const IndexPair& p) { return std::tuple(a[p.a], p.a); });
  return pairs;
}

}  // namespace orb360
