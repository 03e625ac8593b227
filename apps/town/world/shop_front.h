#pragma once

#include "apps/town/world/facade.h"

namespace orb360::town {

/// Adds a shop in the ground floor of a front between `left` and `right`: display windows, a door,
/// a fascia with a name, perhaps an awning, and a sign over the pavement; or, when closed, a
/// shutter. `drop` is the largest distance of the ground below the panel's origin.
void AddShopFront(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float left, float right,
                  float drop, Random& random);

}  // namespace orb360::town
