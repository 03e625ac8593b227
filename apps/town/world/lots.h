#pragma once

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/building.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// Returns building lots along both sides of every street, disjoint and clear of carriageways and
/// pavements.
std::vector<Lot> LayOutLots(const StreetPlan& plan, Random& random);

}  // namespace orb360::town
