#pragma once

#include "apps/town/image/random.h"
#include "apps/town/world/interior/floor_plan.h"
#include "apps/town/world/interior/interior_materials.h"
#include "apps/town/world/lamp.h"

namespace orb360::town {

/// A material with the tint that it has on a surface.
struct Coat {
  MaterialId material = 0;
  Rgba tint{1, 1, 1, 1};
};

/// The surfaces of a room.
struct Finishes {
  Coat floor, wall, ceiling;
  Coat lower_wall;         ///< up to `lower_height`: wainscot, tiles or oil paint
  float lower_height = 0;  ///< metres; 0: none
  Coat woodwork;           ///< skirting boards, door frames and windows
  float skirting = 0;      ///< height of the skirting boards, metres
};

/// Draws the surfaces of a room; rooms of one building resemble each other.
Finishes DrawFinishes(BuildingKind kind, RoomUse use, const InteriorMaterials& m,
                      const Random& building, Random& random);

/// Adds floor, walls with their holes, blocks and ceiling, seen from inside; frames and sills of
/// windows; and an opening of light for each window. Where neither a window nor a doorway is, no
/// ray leaves the room.
void AddRoomShell(const FloorPlan& plan, const Room& room, const Finishes& finishes, Random& random,
                  MeshBuilder& b, std::vector<Lamp>* lamps);

/// Adds the passage between two walls: its sides, its lintel, its threshold and its frame, and
/// perhaps an open door, whose floor area is returned.
std::vector<Area> AddDoorway(const Doorway& way, const Finishes& finishes, Random& random,
                             MeshBuilder& b);

}  // namespace orb360::town
