#pragma once

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/building.h"

namespace orb360::town {

/// Closes the gaps between neighbouring houses towards the street: garden walls, hedges, railings.
void AddBoundaries(const std::vector<Lot>& lots, const Random& random, MeshBuilder& builder);

}  // namespace orb360::town
