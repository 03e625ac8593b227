#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "apps/town/image/random.h"
#include "apps/town/world/mesh.h"

namespace orb360::town {

/// A rectangle along the axes, metres.
struct Area {
  float x0 = 0, x1 = 0, y0 = 0, y1 = 0;

  float width() const { return x1 - x0; }
  float depth() const { return y1 - y0; }
  Vector2f Centre() const { return {0.5F * (x0 + x1), 0.5F * (y0 + y1)}; }
  Area Grown(float by) const { return {x0 - by, x1 + by, y0 - by, y1 + by}; }
  bool Overlaps(const Area& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
  bool Contains(const Vector2f& p) const {
    return p.x() >= x0 && p.x() <= x1 && p.y() >= y0 && p.y() <= y1;
  }
  /// Returns the distance from a point, 0 inside.
  float Distance(const Vector2f& p) const {
    return Vector2f(std::max({x0 - p.x(), p.x() - x1, 0.0F}),
                    std::max({y0 - p.y(), p.y() - y1, 0.0F}))
        .norm();
  }
};

enum class BuildingKind { kDwelling, kOffice, kSchool, kHall, kGarage, kCellar };
inline constexpr int kBuildingKinds = 6;

enum class RoomUse {
  kPassage,
  kLiving,
  kKitchen,
  kBedroom,
  kBathroom,
  kOffice,
  kMeeting,
  kClassroom,
  kWard,
  kStore,
  kHall,
  kGarage,
  kCellar,
};

enum class CeilingKind { kFlat, kBeams, kPanels, kVault, kGable };

/// A side of a room, by the direction in which its wall lies.
enum class Side { kSouth, kEast, kNorth, kWest };

/// A hole in a wall, metres along the axis of the wall and above the floor.
struct WallHole {
  float begin = 0, end = 0;
  float low = 0, high = 0;
  bool is_window = false;
};

struct Room {
  Area area;
  float height = 2.6F;  ///< of the walls; vaults and gables rise above
  float rise = 0;       ///< of the ceiling's middle above the walls, along the longer sides
  CeilingKind ceiling = CeilingKind::kFlat;
  RoomUse use = RoomUse::kPassage;
  std::array<std::vector<WallHole>, 4> holes;  ///< by Side, in order, disjoint
  std::vector<Area> blocks;                    ///< of wall from floor to ceiling: shafts, columns

  /// Returns the wall of a side as seen from inside: the axis of the panel is that of WallHole, or
  /// opposite to it (see OnPanel).
  Panel Wall(Side side) const;
  float WallLength(Side side) const {
    return side == Side::kSouth || side == Side::kNorth ? area.width() : area.depth();
  }
  /// Returns the place on Wall(side) of a coordinate along the axis of a wall.
  float OnPanel(Side side, float coordinate) const;
};

/// An opening between two rooms, through the walls of both.
struct Doorway {
  size_t first, second;  ///< rooms
  bool along_x;          ///< it is passed in the direction of x
  float begin, end;      ///< along its walls, metres
  float near, far;       ///< coordinates of both walls in the direction of passing
  float height;

  /// Returns the floor between both walls.
  Area Floor() const { return along_x ? Area{near, far, begin, end} : Area{begin, end, near, far}; }
};

/// The rooms of one storey, their floors at z = 0. All rooms are linked by doorways.
struct FloorPlan {
  BuildingKind kind = BuildingKind::kDwelling;
  std::vector<Room> rooms;  ///< the first is the passage or hall from which the others branch off
  std::vector<Doorway> doorways;
  float wall = 0.15F;        ///< thickness of walls between rooms, metres
  float outer_wall = 0.35F;  ///< of those with windows
};

/// Plans a storey: rooms on both sides of a passage or a hall, doors, windows, shafts and columns.
FloorPlan PlanFloor(BuildingKind kind, const Random& random);

}  // namespace orb360::town
