#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Adds a clipped hedge from the panel's origin along its x, `length` long: cards of leaves around
/// a dark core, within 0.15 m of `height`, and of `depth` metres behind the panel.
void AddHedge(MeshBuilder& b, const Panel& p, float length, float height, float depth,
              Random& random);

/// Adds ivy to a wall `width` wide and `height` high: cards of leaves, dense below and sparse
/// above.
void AddIvy(MeshBuilder& b, const Panel& p, float width, float height, Random& random);

}  // namespace orb360::town
