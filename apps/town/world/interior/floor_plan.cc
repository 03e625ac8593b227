#include "apps/town/world/interior/floor_plan.h"

#include <algorithm>

#include "apps/town/world/interior/building_habits.h"
#include "apps/town/world/interior/wall_holes.h"

namespace orb360::town {
namespace {

using enum RoomUse;

float Draw(Random& random, const float (&range)[2]) {
  return static_cast<float>(random.Uniform(range[0], range[1]));
}

class Planner {
 public:
  Planner(BuildingKind kind, const Random& random)
      : habits_(HabitsOf(kind)), random_(random.Fork(1)) {
    plan_.kind = kind;
    plan_.wall = Draw(random_, habits_.wall);
    plan_.outer_wall = static_cast<float>(random_.Uniform(0.25, 0.5));
    height_ = Draw(random_, habits_.height);
    door_height_ = std::min(height_ - 0.15F, static_cast<float>(random_.Uniform(1.98, 2.25)));
  }

  FloorPlan Plan() {
    AddPassage();
    bool has_south = random_.Chance(0.5 * habits_.rows);
    const bool has_north = random_.Chance(0.5 * habits_.rows);
    if (!has_south && !has_north && habits_.rows > 1) has_south = true;
    if (has_south) AddRow(Side::kSouth);
    if (has_north) AddRow(Side::kNorth);
    if (random_.Chance(0.5)) AddEnd(Side::kWest);
    if (random_.Chance(0.5)) AddEnd(Side::kEast);
    for (Room& room : plan_.rooms) {
      AddBlocks(&room);
      if (random_.Chance(habits_.window)) AddWindows(plan_, random_, &room);
    }
    return std::move(plan_);
  }

 private:
  void AddPassage() {
    Room passage;
    passage.area = {0, Draw(random_, habits_.passage_length), 0,
                    Draw(random_, habits_.passage_width)};
    if (plan_.kind == BuildingKind::kHall) passage.use = kHall;
    if (plan_.kind == BuildingKind::kGarage) passage.use = kGarage;
    if (plan_.kind == BuildingKind::kOffice && passage.area.depth() > 3.5F) passage.use = kOffice;
    if (plan_.kind == BuildingKind::kDwelling && random_.Chance(0.3)) {
      passage.area.y1 = static_cast<float>(random_.Uniform(3.2, 6));
      passage.use = kLiving;
    }
    Finish(&passage);
    plan_.rooms.push_back(passage);
  }

  void AddRow(Side side) {
    const Area passage = plan_.rooms[0].area;
    const float depth = Draw(random_, habits_.room_depth);
    const float near = side == Side::kNorth ? passage.y1 + plan_.wall : passage.y0 - plan_.wall;
    float x = passage.x0 - static_cast<float>(random_.Uniform(0, 1.5));
    bool has_neighbour = false;
    while (x < passage.x1 - 1.5F) {
      const float width = Draw(random_, habits_.room_width);
      const bool is_there = random_.Chance(plan_.kind == BuildingKind::kHall ? 0.6 : 0.93);
      if (is_there) {
        Room room;
        room.area = side == Side::kNorth ? Area{x, x + width, near, near + depth}
                                         : Area{x, x + width, near - depth, near};
        room.use = DrawUse(width * depth);
        Finish(&room);
        plan_.rooms.push_back(room);
        const size_t index = plan_.rooms.size() - 1;
        if (!LinkAlongY(0, index, side)) {
          if (!has_neighbour || !LinkAlongX(index - 1, index)) {
            plan_.rooms.pop_back();
            break;
          }
        } else if (has_neighbour && random_.Chance(habits_.link)) {
          LinkAlongX(index - 1, index);
        }
      }
      has_neighbour = is_there;
      x += width + plan_.wall;
    }
  }

  /// Adds a room at an end of the passage.
  void AddEnd(Side side) {
    const Area passage = plan_.rooms[0].area;
    const float width = Draw(random_, habits_.room_width);
    const float depth = std::max(Draw(random_, habits_.room_depth), 2.0F);
    const float shift = static_cast<float>(random_.Uniform(-0.4, 0.4)) * depth;
    const float y = 0.5F * (passage.y0 + passage.y1) + shift;
    const float x = side == Side::kWest ? passage.x0 - plan_.wall - width : passage.x1 + plan_.wall;
    Room room;
    room.area = {x, x + width, y - 0.5F * depth, y + 0.5F * depth};
    for (const Room& other : plan_.rooms) {
      if (other.area.Grown(0.5F * plan_.wall).Overlaps(room.area.Grown(0.5F * plan_.wall - 0.01F)))
        return;
    }
    room.use = DrawUse(width * depth);
    Finish(&room);
    plan_.rooms.push_back(room);
    const size_t index = plan_.rooms.size() - 1;
    const bool is_linked = side == Side::kWest ? LinkAlongX(index, 0) : LinkAlongX(0, index);
    if (!is_linked) plan_.rooms.pop_back();
  }

  RoomUse DrawUse(float area) {
    for (int i = 0; i < 8; ++i) {
      const RoomUse use = habits_.uses[static_cast<size_t>(used_++) % habits_.uses.size()];
      const bool is_small = use == kBathroom || use == kStore || use == kKitchen || use == kPassage;
      if (random_.Chance(0.25)) continue;
      if ((use == kLiving || use == kClassroom || use == kMeeting) && area < 13) continue;
      if (use == kBathroom && area > 18) continue;
      if (area < 7 && !is_small && use != kCellar) continue;
      return use;
    }
    return plan_.kind == BuildingKind::kCellar || plan_.kind == BuildingKind::kGarage ? kCellar
                                                                                      : kStore;
  }

  /// Chooses height and ceiling.
  void Finish(Room* room) {
    const bool is_large = room->use == kHall || room->use == kGarage;
    room->height = height_;
    if (!is_large && plan_.kind == BuildingKind::kHall)
      room->height = static_cast<float>(random_.Uniform(2.5, 3.4));
    else if (room->use == kPassage && random_.Chance(0.3))
      room->height =
          std::max(door_height_ + 0.12F, height_ - static_cast<float>(random_.Uniform(0, 0.4)));
    const float narrow = std::min(room->area.width(), room->area.depth());
    switch (plan_.kind) {
      case BuildingKind::kDwelling:
        if (random_.Chance(0.15)) room->ceiling = CeilingKind::kBeams;
        if (random_.Chance(0.12)) Raise(room, CeilingKind::kGable, 0.35F * narrow);
        break;
      case BuildingKind::kOffice:
      case BuildingKind::kSchool:
        if (random_.Chance(0.65)) room->ceiling = CeilingKind::kPanels;
        break;
      case BuildingKind::kHall:
        if (room->use == kHall && random_.Chance(0.65))
          Raise(room, CeilingKind::kGable, static_cast<float>(random_.Uniform(0.06, 0.2)) * narrow);
        else if (room->use == kHall)
          room->ceiling = CeilingKind::kBeams;
        break;
      case BuildingKind::kGarage:
        if (room->use == kGarage && random_.Chance(0.5)) room->ceiling = CeilingKind::kBeams;
        break;
      case BuildingKind::kCellar:
        if (random_.Chance(0.6))
          Raise(room, CeilingKind::kVault, static_cast<float>(random_.Uniform(0.15, 0.4)) * narrow);
        break;
    }
  }

  static void Raise(Room* room, CeilingKind ceiling, float rise) {
    room->ceiling = ceiling;
    room->rise = rise;
  }

  /// Links two rooms, the second to the north or south of the first.
  bool LinkAlongY(size_t first, size_t second, Side side) {
    const Area& a = plan_.rooms[first].area;
    const Area& b = plan_.rooms[second].area;
    const bool north = side == Side::kNorth;
    return Link({first, second, false, std::max(a.x0, b.x0), std::min(a.x1, b.x1),
                 north ? a.y1 : b.y1, north ? b.y0 : a.y0, 0},
                side, north ? Side::kSouth : Side::kNorth);
  }
  /// Links two rooms, the second to the east of the first.
  bool LinkAlongX(size_t first, size_t second) {
    const Area& a = plan_.rooms[first].area;
    const Area& b = plan_.rooms[second].area;
    return Link({first, second, true, std::max(a.y0, b.y0), std::min(a.y1, b.y1), a.x1, b.x0, 0},
                Side::kEast, Side::kWest);
  }

  /// Chooses the place of a doorway within [begin, end] and cuts it out of both walls.
  bool Link(Doorway way, Side on_first, Side on_second) {
    const float low = way.begin + 0.2F;
    const float high = way.end - 0.2F;
    for (int attempt = 0; attempt < 6; ++attempt) {
      const bool is_wide = plan_.rooms[way.second].use == kLiving && random_.Chance(0.3);
      const float width = is_wide ? std::min(2.4F, high - low) : Draw(random_, habits_.door_width);
      if (width < 0.75F || high - low < width) continue;
      way.begin = static_cast<float>(random_.Uniform(low, high - width));
      way.end = way.begin + width;
      Room& a = plan_.rooms[way.first];
      Room& b = plan_.rooms[way.second];
      way.height = std::min({door_height_, a.height - 0.1F, b.height - 0.1F});
      const WallHole hole{way.begin, way.end, 0, way.height, false};
      Room copy = a;
      if (!AddHole(&copy, on_first, hole) || !AddHole(&b, on_second, hole)) continue;
      a = copy;
      plan_.doorways.push_back(way);
      return true;
    }
    return false;
  }

  bool MeetsDoor(const Room& room, const Area& area) const {
    for (const Doorway& way : plan_.doorways) {
      Area keep = way.Floor().Grown(0.25F);
      (way.along_x ? keep.x0 : keep.y0) -= 1;
      (way.along_x ? keep.x1 : keep.y1) += 1;
      if (keep.Overlaps(area)) return true;
    }
    return std::ranges::any_of(room.blocks,
                               [&](const Area& b) { return b.Grown(0.9F).Overlaps(area); });
  }

  /// Adds shafts in corners (which make rooms L-shaped), piers along walls, and columns.
  void AddBlocks(Room* room) {
    const Area& a = room->area;
    const auto add = [&](const Area& block) {
      if (!MeetsDoor(*room, block)) room->blocks.push_back(block);
    };
    const bool is_large = std::min(a.width(), a.depth()) > 7;
    if (is_large && random_.Chance(room->use == kGarage ? 1.0 : 0.6)) {
      const auto pitch_x = static_cast<float>(random_.Uniform(4.5, 8));
      const auto pitch_y = static_cast<float>(random_.Uniform(4.5, 8));
      const auto half = static_cast<float>(random_.Uniform(0.12, 0.35));
      for (float x = a.x0 + 0.6F * pitch_x; x < a.x1 - 1.5F; x += pitch_x) {
        for (float y = a.y0 + 0.6F * pitch_y; y < a.y1 - 1.5F; y += pitch_y)
          add({x - half, x + half, y - half, y + half});
      }
    }
    if (room->rise > 0) return;  // blocks end at the walls' height
    if (random_.Chance(0.55)) {
      const auto w = static_cast<float>(random_.Uniform(0.1, 0.4)) * a.width();
      const auto d = static_cast<float>(random_.Uniform(0.1, 0.4)) * a.depth();
      const bool west = random_.Chance(0.5);
      const bool south = random_.Chance(0.5);
      add({west ? a.x0 : a.x1 - w, west ? a.x0 + w : a.x1, south ? a.y0 : a.y1 - d,
           south ? a.y0 + d : a.y1});
    }
    if (random_.Chance(0.35)) {
      const auto deep = static_cast<float>(random_.Uniform(0.15, 0.5));
      const auto wide = static_cast<float>(random_.Uniform(0.3, 1.2));
      const auto x = static_cast<float>(
          random_.Uniform(a.x0 + 0.5, std::max(a.x0 + 0.6F, a.x1 - 0.5F - wide)));
      if (random_.Chance(0.5))
        add({x, x + wide, a.y0, a.y0 + deep});
      else
        add({x, x + wide, a.y1 - deep, a.y1});
    }
  }

  Habits habits_;
  Random random_;
  FloorPlan plan_;
  float height_ = 0;
  float door_height_ = 0;
  int used_ = 0;
};

}  // namespace

Panel Room::Wall(Side side) const {
  const Vector3f up = Vector3f::UnitZ();
  switch (side) {
    case Side::kSouth:
      return {{area.x1, area.y0, 0}, -Vector3f::UnitX(), up, Vector3f::UnitY()};
    case Side::kEast:
      return {{area.x1, area.y1, 0}, -Vector3f::UnitY(), up, -Vector3f::UnitX()};
    case Side::kNorth:
      return {{area.x0, area.y1, 0}, Vector3f::UnitX(), up, -Vector3f::UnitY()};
    case Side::kWest:
      break;
  }
  return {{area.x0, area.y0, 0}, Vector3f::UnitY(), up, Vector3f::UnitX()};
}

float Room::OnPanel(Side side, float coordinate) const {
  switch (side) {
    case Side::kSouth:
      return area.x1 - coordinate;
    case Side::kEast:
      return area.y1 - coordinate;
    case Side::kNorth:
      return coordinate - area.x0;
    case Side::kWest:
      break;
  }
  return coordinate - area.y0;
}

FloorPlan PlanFloor(BuildingKind kind, const Random& random) {
  return Planner(kind, random).Plan();
}

}  // namespace orb360::town
