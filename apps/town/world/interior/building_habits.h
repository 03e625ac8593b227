#pragma once

#include <span>

#include "apps/town/world/interior/floor_plan.h"

namespace orb360::town {

/// Ranges from which the plan of a kind of building is drawn, metres.
struct Habits {
  float passage_length[2];
  float passage_width[2];
  float height[2];
  float room_width[2];
  float room_depth[2];
  float door_width[2];
  float wall[2];
  double rows;    ///< mean number of sides of the passage with rooms
  double link;    ///< probability of a door between neighbouring rooms
  double window;  ///< probability of windows in a room
  std::span<const RoomUse> uses;
};

/// Returns the ranges of a kind of building.
Habits HabitsOf(BuildingKind kind);

}  // namespace orb360::town
