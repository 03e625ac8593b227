#include "apps/town/world/interior/wall_fittings.h"

#include <algorithm>
#include <vector>

#include "apps/town/world/interior/wall_items.h"

namespace orb360::town {
namespace {

void FitWall(Placement& placement, Side side, BuildingKind kind) {
  Kit& kit = placement.kit();
  const Room& room = placement.room();
  const Panel wall = room.Wall(side);
  const float length = room.WallLength(side);
  const bool is_home = kind == BuildingKind::kDwelling;
  const auto& holes = room.holes[static_cast<size_t>(side)];
  std::vector<Placement::Span> used = placement.Standing(side);
  // Sockets and switches sit on the wall, not in its holes.
  const auto add_socket = [&](float x, float z) {
    const bool is_in_hole = std::ranges::any_of(holes, [&](const WallHole& hole) {
      const float a = room.OnPanel(side, hole.begin);
      const float c = room.OnPanel(side, hole.end);
      return x > std::min(a, c) - 0.1F && x < std::max(a, c) + 0.1F && z < hole.high &&
             z > hole.low - 0.1F;
    });
    if (!is_in_hole && x > 0.1F && x < length - 0.1F) AddSocket(kit, wall, x, z);
  };
  const bool has_curtains = (is_home && placement.Chance(0.7)) ||
                            (kind == BuildingKind::kOffice && placement.Chance(0.15));
  for (const WallHole& hole : holes) {
    const float a = room.OnPanel(side, hole.begin);
    const float c = room.OnPanel(side, hole.end);
    const float left = std::min(a, c);
    const float right = std::max(a, c);
    used.push_back({left - 0.1F, right + 0.1F, 9});
    if (!hole.is_window) {
      if (placement.Chance(0.6)) add_socket(left > 0.5F ? left - 0.2F : right + 0.2F, 1.1F);
      continue;
    }
    const bool is_blocked = std::ranges::any_of(
        placement.Standing(side),
        [&](const Placement::Span& span) { return span.left < right && span.right > left; });
    if (!is_blocked && hole.low > 0.6F && hole.low < 1.2F && placement.Chance(0.6))
      AddRadiator(kit, wall, left + 0.05F, right - left - 0.1F, hole.low - 0.22F);
    if (!has_curtains || is_blocked) continue;
    const float bottom = placement.Chance(0.6) ? 0.03F : std::max(0.03F, hole.low - 0.15F);
    const float top = std::min(hole.high + 0.12F, room.height - 0.03F);
    const float wide = (right - left) * placement.Draw(0.15, 0.4);
    AddCurtain(kit, wall, std::max(0.02F, left - 0.15F), left + wide, bottom, top);
    if (placement.Chance(0.85))
      AddCurtain(kit, wall, right - wide, std::min(length - 0.02F, right + 0.15F), bottom, top);
    kit.b.AddTube(kit.Use(kit.metal), wall.At(std::max(0.01F, left - 0.2F), top, 0.09F),
                  wall.At(std::min(length - 0.01F, right + 0.2F), top, 0.09F), 0.012F, 0.012F, 8);
  }
  for (int i = 0; i < static_cast<int>(length / 3) + 1; ++i) {
    const float x = placement.Draw(0.2, length - 0.2F);
    add_socket(x, placement.Draw(0.25, 0.32));
  }
  const int count = kit.random.Int(static_cast<int>(length / 1.3F) + 2);
  for (int i = 0; i < count; ++i) {
    if (!placement.Chance(is_home ? 0.75 : 0.6)) continue;
    const bool is_board = !is_home && placement.Chance(0.35);
    const float width = is_board ? placement.Draw(0.9, 2.4) : placement.Draw(0.2, 1);
    const float height = is_board ? placement.Draw(0.7, 1.2) : placement.Draw(0.2, 0.8);
    if (length < width + 0.3F) continue;
    const float x = placement.Draw(0.15, length - width - 0.15F);
    const float z =
        placement.Draw(1.05, std::max(1.1F, std::min(1.6F, room.height - height - 0.2F)));
    if (z + height > room.height - 0.1F) continue;
    if (std::ranges::any_of(used, [&](const Placement::Span& span) {
          return span.height > z - 0.05F && span.left < x + width + 0.08F && span.right > x - 0.08F;
        }))
      continue;
    if (is_board)
      AddBoard(kit, wall, x, z, width, height);
    else
      AddPicture(kit, wall, x, z, width, height);
    used.push_back({x, x + width, 9});
  }
}

/// Pipes above the heads of people and the doors of the wall.
void FitPipes(Placement& placement, Side side) {
  const Room& room = placement.room();
  const Panel wall = room.Wall(side);
  const Area corner = Placement::AreaOf(wall, kBranchWidth, kBranchDepth);
  PipeSpace space{1.95F, room.height, placement.IsFree(corner)};
  for (const WallHole& hole : room.holes[static_cast<size_t>(side)]) {
    if (!hole.is_window) space.low = std::max(space.low, hole.high);
  }
  if (AddPipes(placement.kit(), wall, room.WallLength(side), space)) placement.Take(corner);
}

}  // namespace

void FitWalls(Placement& placement, BuildingKind kind) {
  const Room& room = placement.room();
  const bool is_raw =
      kind == BuildingKind::kCellar || kind == BuildingKind::kGarage || kind == BuildingKind::kHall;
  for (const Side side : {Side::kSouth, Side::kEast, Side::kNorth, Side::kWest}) {
    if (room.use != RoomUse::kBathroom) FitWall(placement, side, kind);
    if (is_raw && placement.Chance(0.6)) FitPipes(placement, side);
  }
}

}  // namespace orb360::town
