#pragma once

#include <vector>

#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/interior/kit.h"
#include "apps/town/world/lamp.h"

namespace orb360::town {

/// Furnishes a room for its use: furniture along its walls and in its middle, and what hangs on the
/// walls. Doorways and the ground before them stay free. Appends the floor areas that are taken.
void FurnishRoom(Kit& kit, const FloorPlan& plan, const Room& room, float brightness,
                 std::vector<Area>* taken, std::vector<Lamp>* lamps);

}  // namespace orb360::town
