#pragma once

#include <vector>

#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/interior/kit.h"
#include "apps/town/world/lamp.h"

namespace orb360::town {

/// Hangs lamps below the ceiling of a room: panels, fluorescent tubes, spots, bulbs, pendants or
/// high-bay lamps. Together they light the floor as a white matte surface of about `brightness`
/// radiance does; some lamps are off. 0: all are off. Appends the floor below lamps that hang low.
void AddRoomLamps(Kit& kit, const Room& room, BuildingKind kind, float brightness,
                  std::vector<Area>* taken, std::vector<Lamp>* lamps);

}  // namespace orb360::town
