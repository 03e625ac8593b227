#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/import/walkable_grid.h"

namespace orb360::town {

/// Returns places from `start` to goals that are drawn one after the other, each one step from the
/// one before it, until the way is at least `length` metres long. Steps with less than twice the
/// wanted clearance cost more. Goals prefer parts that were not visited, and ways that go on in the
/// direction of the last one. Empty if no step leads away from the start.
std::vector<uint32_t> FindRoute(const WalkableGrid& grid, uint32_t start, double clearance,
                                double length, Random* random);

}  // namespace orb360::town
