#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace orb360::nn {

/// A piece of memory and the steps during which it is needed, both included.
struct Lifetime {
  std::size_t bytes = 0;
  int first = 0;
  int last = 0;
};

/// Where every piece lies in one block of memory.
struct MemoryPlan {
  std::vector<std::size_t> offsets;  // multiples of kAlignment
  std::size_t bytes = 0;             // of the whole block
};

/// Packs pieces so that none overlap that are needed during the same step: each at the place that
/// leaves the smallest gap, in two orders (the largest first, the longest needed first), of which
/// the better one is taken. The same pieces give the same plan.
MemoryPlan PlanMemory(std::span<const Lifetime> pieces);

}  // namespace orb360::nn
