#include "nn/graph/memory_plan.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include <orb360/nn/base/check.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {
namespace {

std::size_t Aligned(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

bool Meet(const Lifetime& a, const Lifetime& b) { return a.first <= b.last && b.first <= a.last; }

/// Places the pieces one after the other, each where it leaves the smallest gap between the pieces
/// needed at the same time, or behind all of them.
MemoryPlan PlaceInOrder(std::span<const Lifetime> pieces, std::span<const std::size_t> order) {
  MemoryPlan plan{std::vector<std::size_t>(pieces.size()), 0};
  std::vector<std::size_t> placed;  // by offset
  for (const std::size_t piece : order) {
    const std::size_t bytes = Aligned(pieces[piece].bytes);
    std::size_t best = 0;
    std::size_t best_gap = std::numeric_limits<std::size_t>::max();
    std::size_t end = 0;  // of what lies before and is needed at the same time
    for (const std::size_t other : placed) {
      if (!Meet(pieces[piece], pieces[other])) continue;
      const std::size_t start = plan.offsets[other];
      if (start >= end + bytes && start - end < best_gap) {
        best = end;
        best_gap = start - end;
      }
      end = std::max(end, start + Aligned(pieces[other].bytes));
    }
    if (best_gap == std::numeric_limits<std::size_t>::max()) best = end;
    plan.offsets[piece] = best;
    plan.bytes = std::max(plan.bytes, best + bytes);
    const auto behind = std::ranges::upper_bound(
        placed, best, {}, [&](std::size_t other) { return plan.offsets[other]; });
    placed.insert(behind, piece);
  }
  return plan;
}

}  // namespace

MemoryPlan PlanMemory(std::span<const Lifetime> pieces) {
  for (const Lifetime& piece : pieces) ORB360_CHECK(piece.first <= piece.last, piece.first);
  const auto plan_by = [&](const auto& key) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater(), key);
    return PlaceInOrder(pieces, order);
  };
  // Long-lived pieces fragment the memory unless they lie together, and large ones need a choice of
  // places. It depends on the network which matters more, so both orders are tried.
  MemoryPlan large_first = plan_by([&](std::size_t i) { return pieces[i].bytes; });
  MemoryPlan long_first = plan_by([&](std::size_t i) { return pieces[i].last - pieces[i].first; });
  return large_first.bytes < long_first.bytes ? large_first : long_first;
}

}  // namespace orb360::nn
