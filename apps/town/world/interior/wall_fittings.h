#pragma once

#include "apps/town/world/interior/placement.h"

namespace orb360::town {

/// Puts radiators, curtains, switches, sockets, pictures, boards and pipes on the walls of a room,
/// where no furniture hides them.
void FitWalls(Placement& placement, BuildingKind kind);

}  // namespace orb360::town
