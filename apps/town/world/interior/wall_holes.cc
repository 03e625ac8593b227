#include "apps/town/world/interior/wall_holes.h"

#include <algorithm>

namespace orb360::town {
namespace {

size_t Index(Side side) { return static_cast<size_t>(side); }

/// Returns true if no room lies behind a wall.
bool IsOuter(const FloorPlan& plan, const Room& room, Side side) {
  constexpr float kFree = 3;  // metres
  Area beyond = room.area;
  if (side == Side::kSouth) beyond = {beyond.x0, beyond.x1, beyond.y0 - kFree, beyond.y0 - 0.01F};
  if (side == Side::kNorth) beyond = {beyond.x0, beyond.x1, beyond.y1 + 0.01F, beyond.y1 + kFree};
  if (side == Side::kWest) beyond = {beyond.x0 - kFree, beyond.x0 - 0.01F, beyond.y0, beyond.y1};
  if (side == Side::kEast) beyond = {beyond.x1 + 0.01F, beyond.x1 + kFree, beyond.y0, beyond.y1};
  return std::ranges::none_of(plan.rooms,
                              [&](const Room& other) { return other.area.Overlaps(beyond); });
}

}  // namespace

bool AddHole(Room* room, Side side, const WallHole& hole) {
  constexpr float kApart = 0.12F;  // metres
  const bool is_x = side == Side::kSouth || side == Side::kNorth;
  const float begin = is_x ? room->area.x0 : room->area.y0;
  const float end = is_x ? room->area.x1 : room->area.y1;
  if (hole.begin < begin + kApart || hole.end > end - kApart) return false;
  auto& holes = room->holes[Index(side)];
  for (const WallHole& other : holes) {
    if (hole.begin < other.end + kApart && other.begin < hole.end + kApart) return false;
  }
  holes.push_back(hole);
  std::ranges::sort(holes, {}, &WallHole::begin);
  return true;
}

void AddWindows(const FloorPlan& plan, Random& random, Room* room) {
  const bool is_low = plan.kind == BuildingKind::kCellar || plan.kind == BuildingKind::kGarage;
  const bool is_hall = room->use == RoomUse::kHall;
  const auto width = static_cast<float>(is_low ? random.Uniform(0.5, 1) : random.Uniform(0.8, 2.2));
  const auto gap = static_cast<float>(random.Uniform(0.25, 1.8));
  float low = static_cast<float>(random.Chance(0.15) ? 0.05 : random.Uniform(0.5, 1.05));
  float high = std::min(room->height - 0.12F, static_cast<float>(random.Uniform(2, 2.8)));
  if (is_low) low = room->height - 0.75F, high = room->height - 0.25F;
  if (is_hall) low = 0.55F * room->height, high = 0.9F * room->height;
  if (room->use == RoomUse::kBathroom) low = 1.3F;
  for (const Side side : {Side::kSouth, Side::kNorth, Side::kWest, Side::kEast}) {
    if (!IsOuter(plan, *room, side) || random.Chance(0.35)) continue;
    const bool is_x = side == Side::kSouth || side == Side::kNorth;
    const float begin = (is_x ? room->area.x0 : room->area.y0) + 0.4F;
    const float end = (is_x ? room->area.x1 : room->area.y1) - 0.4F;
    const int count = std::max(0, static_cast<int>((end - begin + gap) / (width + gap)));
    const float used = static_cast<float>(count) * (width + gap) - gap;
    for (int i = 0; i < count; ++i) {
      const float at = begin + 0.5F * (end - begin - used) + static_cast<float>(i) * (width + gap);
      if (random.Chance(0.2)) continue;
      const Area inside = is_x ? Area{at, at + width, room->area.y0, room->area.y1}
                               : Area{room->area.x0, room->area.x1, at, at + width};
      Area strip = inside;
      if (side == Side::kSouth) strip.y1 = strip.y0 + 0.1F;
      if (side == Side::kNorth) strip.y0 = strip.y1 - 0.1F;
      if (side == Side::kWest) strip.x1 = strip.x0 + 0.1F;
      if (side == Side::kEast) strip.x0 = strip.x1 - 0.1F;
      if (std::ranges::any_of(room->blocks, [&](const Area& b) { return b.Overlaps(strip); }))
        continue;
      AddHole(room, side, {at, at + width, low, high, true});
    }
  }
}

}  // namespace orb360::town
