#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/street_plan.h"

namespace orb360::town {

/// Adds to a lattice of streets with its tour, where there is room: a roundabout and a bridge on
/// the tour, the medians of avenues, and a park in place of a block beside the tour.
void AddPlaces(int columns, int rows, double spacing, const Random& random, StreetPlan* plan);

}  // namespace orb360::town
