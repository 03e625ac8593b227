#pragma once

#include "apps/town/world/building.h"
#include "apps/town/world/facade.h"

namespace orb360::town {

/// Closes a building above its eaves: a flat roof behind a parapet, or a gabled, hipped or mansard
/// roof with gutters, ridge, chimneys, dormers, skylights and aerials.
void AddRoof(MeshBuilder& b, const FacadeStyle& style, const Lot& lot, Random& random);

}  // namespace orb360::town
