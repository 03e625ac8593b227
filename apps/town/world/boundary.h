#pragma once

#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/building.h"

namespace orb360::town {

/// Closes the gaps between neighbouring houses towards the street: garden walls, hedges, railings.
void AddBoundaries(const std::vector<Lot>& lots, const Random& random, MeshBuilder& builder);

/// A clipped hedge from the panel's origin along its x, `length` long: cards of leaves around a
/// dark core, within 0.15 m of `height` and of `depth` metres behind the panel.
void AddHedge(MeshBuilder& b, const Panel& p, float length, float height, float depth,
              Random& random);

}  // namespace orb360::town
