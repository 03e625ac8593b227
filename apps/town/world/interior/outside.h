#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Adds what is seen from the windows of a storey, as instances that the sky lights: the ground
/// some metres below, houses across the street, and trees.
void AddOutside(const FloorPlan& plan, const Materials& materials, const Random& random,
                Scenery* scenery);

}  // namespace orb360::town
