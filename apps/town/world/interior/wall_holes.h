#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/interior/floor_plan.h"

namespace orb360::town {

/// Puts a hole into a wall. Returns false where it would meet another one or a corner.
bool AddHole(Room* room, Side side, const WallHole& hole);

/// Adds rows of windows to walls of a room of the plan behind which no room lies.
void AddWindows(const FloorPlan& plan, Random& random, Room* room);

}  // namespace orb360::town
