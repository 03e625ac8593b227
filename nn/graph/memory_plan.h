#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace orb360::nn {

/// A piece of memory and the first and last step at which it is needed.
struct Lifetime {
  std::size_t bytes = 0;
  int first = 0;
  int last = 0;
};

/// Offset of every piece in one block of memory.
struct MemoryPlan {
  std::vector<std::size_t> offsets;  // multiples of kAlignment
  std::size_t bytes = 0;             // of the whole block
};

/// Packs pieces so that pieces needed during the same step do not overlap. Each is placed where it
/// leaves the smallest gap, in two orders (largest first, longest-lived first), and the better plan
/// is returned. The same pieces give the same plan.
MemoryPlan PlanMemory(std::span<const Lifetime> pieces);

}  // namespace orb360::nn
