#include "apps/town/world/interior/room_lamps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orb360::town {
namespace {

enum class LampKind { kPanel, kTube, kSpot, kBulb, kPendant, kHighBay };

LampKind DrawKind(Random& random, const Room& room, BuildingKind kind) {
  switch (kind) {
    case BuildingKind::kDwelling:
      return random.Chance(0.45)  ? LampKind::kPendant
             : random.Chance(0.4) ? LampKind::kSpot
                                  : LampKind::kPanel;
    case BuildingKind::kOffice:
    case BuildingKind::kSchool:
      return random.Chance(0.5)   ? LampKind::kPanel
             : random.Chance(0.6) ? LampKind::kTube
                                  : LampKind::kSpot;
    case BuildingKind::kHall:
      return room.use == RoomUse::kHall && random.Chance(0.6) ? LampKind::kHighBay
                                                              : LampKind::kTube;
    case BuildingKind::kGarage:
      return LampKind::kTube;
    case BuildingKind::kCellar:
      break;
  }
  return random.Chance(0.6) ? LampKind::kBulb : LampKind::kTube;
}

/// Size of the light's rectangle, metres along x and y.
Vector2f SizeOf(LampKind kind, Kit& kit) {
  switch (kind) {
    case LampKind::kPanel:
      return kit.random.Chance(0.6) ? Vector2f(0.6F, 0.6F) : Vector2f(1.2F, 0.3F);
    case LampKind::kTube:
      return {kit.Draw(1.1, 1.6), 0.07F};
    case LampKind::kSpot:
    case LampKind::kBulb:
      return {0.1F, 0.1F};
    case LampKind::kPendant:
    case LampKind::kHighBay:
      break;
  }
  return {0.32F, 0.32F};
}

}  // namespace

void AddRoomLamps(Kit& kit, const Room& room, BuildingKind kind, float brightness,
                  std::vector<Area>* taken, std::vector<Lamp>* lamps) {
  const LampKind lamp = DrawKind(kit.random, room, kind);
  const Vector2f size = SizeOf(lamp, kit);
  const Area& a = room.area;
  const float ridge =
      room.height + (room.ceiling == CeilingKind::kGable ? 0.0F : 0.55F * room.rise);
  const bool single = lamp == LampKind::kPendant && a.width() * a.depth() < 30;
  const float pitch = lamp == LampKind::kSpot ? kit.Draw(1.1, 1.8)
                      : room.height > 4       ? kit.Draw(4.5, 7)
                                              : kit.Draw(2.2, 4);
  const int columns = single ? 1 : std::clamp(static_cast<int>(a.width() / pitch + 0.5F), 1, 8);
  const int rows = single ? 1 : std::clamp(static_cast<int>(a.depth() / pitch + 0.5F), 1, 8);
  const bool turned =
      kit.random.Chance(0.5) && a.depth() / static_cast<float>(rows) > size.x() + 0.1F;
  const Vector2f half = 0.5F * (turned ? Vector2f(size.y(), size.x()) : size);
  const double warm = kit.random.Uniform(0, 1);
  const Vector3f colour(1, static_cast<float>(0.98 - 0.2 * warm),
                        static_cast<float>(1 - 0.45 * warm));
  // About half of the light of a lamp reaches the floor.
  const float lamp_area = size.x() * size.y() * static_cast<float>(columns * rows);
  const float radiance = brightness * a.width() * a.depth() / (0.55F * lamp_area);
  float drop = 0.004F;  // of the light below the ceiling
  if (lamp == LampKind::kTube) drop = room.height > 3 ? kit.Draw(0.1, 0.6) : 0.09F;
  if (lamp == LampKind::kBulb) drop = kit.Draw(0.12, 0.35);
  if (lamp == LampKind::kPendant) drop = std::min(kit.Draw(0.35, 1), room.height - 1.95F);
  if (lamp == LampKind::kHighBay) drop = kit.Draw(0.4, 0.9);
  if (room.ceiling == CeilingKind::kBeams) drop = std::max(drop, 0.02F);
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < rows; ++k) {
      const float x =
          a.x0 + a.width() * (static_cast<float>(i) + 0.5F) / static_cast<float>(columns);
      const float y = a.y0 + a.depth() * (static_cast<float>(k) + 0.5F) / static_cast<float>(rows);
      const Area place{x - half.x(), x + half.x(), y - half.y(), y + half.y()};
      if (std::ranges::any_of(
              room.blocks, [&](const Area& block) { return block.Grown(0.05F).Overlaps(place); }))
        continue;
      const float z = ridge - drop;
      constexpr float kLow = 2.6F;  // metres; cameras are carried below
      if (drop > 0.1F && z < kLow) taken->push_back(place.Grown(0.1F));
      const bool is_lit = brightness > 0 && !kit.random.Chance(0.12);
      kit.b.set_tint({colour.x(), colour.y(), colour.z(), 1});
      const MaterialId glass = is_lit ? kit.m.lamp : kit.m.plain;
      const Panel down{
          {place.x0, place.y0, z}, Vector3f::UnitY(), Vector3f::UnitX(), -Vector3f::UnitZ()};
      if (lamp == LampKind::kBulb || (lamp == LampKind::kPendant && size.x() < 0.3F)) {
        kit.b.AddEllipsoid(glass, {x, y, z + 0.05F}, {0.04F, 0.04F, 0.055F});
      } else if (lamp == LampKind::kPendant) {
        kit.b.AddEllipsoid(glass, {x, y, z + 0.14F}, {0.16F, 0.16F, 0.13F});
      } else {
        kit.b.AddRectangle(glass, down, 0, 2 * half.y(), 0, 2 * half.x());
      }
      const MaterialId body = kit.UseGrey(lamp == LampKind::kHighBay ? 0.25F : 0.8F);
      if (lamp == LampKind::kTube) {
        kit.b.AddBox(body, down, -0.03F, 2 * half.y() + 0.03F, -0.03F, 2 * half.x() + 0.03F, -0.07F,
                     -0.002F);
        for (const float at : {-0.6F, 0.6F})
          kit.b.AddTube(body,
                        {x + at * half.x(), y + at * half.y() * (turned ? 1.0F : 0.0F), z + 0.06F},
                        {x + at * half.x(), y + at * half.y() * (turned ? 1.0F : 0.0F), ridge},
                        0.008F, 0.008F, 6);
      } else if (lamp == LampKind::kHighBay) {
        kit.b.AddTube(body, {x, y, z - 0.02F}, {x, y, z + 0.22F}, 0.27F, 0.1F, 20);
        kit.b.AddTube(body, {x, y, z + 0.2F}, {x, y, ridge + 0.5F * room.rise}, 0.012F, 0.012F, 6);
      } else if (lamp == LampKind::kBulb || lamp == LampKind::kPendant) {
        kit.b.AddTube(kit.UseGrey(0.1F), {x, y, z + 0.08F}, {x, y, ridge + 0.45F * room.rise},
                      0.006F, 0.006F, 6);
      } else {
        kit.b.AddBox(body, down, -0.02F, 2 * half.y() + 0.02F, -0.02F, 2 * half.x() + 0.02F, -0.02F,
                     -0.002F);
      }
      if (!is_lit) continue;
      lamps->push_back({down.At(0, 0, 0.012F), 2 * half.y() * down.right, 2 * half.x() * down.up,
                        radiance * colour, false});
      if (lamp != LampKind::kBulb && lamp != LampKind::kPendant) continue;
      // These shine upwards as well.
      const float top = z + (lamp == LampKind::kPendant ? 0.28F : 0.12F);
      lamps->push_back({{place.x0, place.y0, top},
                        2 * half.x() * Vector3f::UnitX(),
                        2 * half.y() * Vector3f::UnitY(),
                        0.7F * radiance * colour,
                        false});
    }
  }
}

}  // namespace orb360::town
