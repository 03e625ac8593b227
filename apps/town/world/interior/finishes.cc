#include <array>
#include <span>

#include "apps/town/world/interior/room_shell.h"

namespace orb360::town {
namespace {

/// Returns a colour of wall paint; most are near white.
Rgba DrawPaintTint(Random& random) {
  const double value = random.Chance(0.65) ? random.Uniform(0.8, 1) : random.Uniform(0.35, 0.8);
  const double colour = random.Chance(0.6) ? random.Uniform(0, 0.12) : random.Uniform(0.1, 0.45);
  const int hue = random.Int(5);
  static constexpr std::array<Rgba, 5> kDampened = {{{0, 0.3F, 1, 1},
                                                     {0.6F, 0.2F, 1, 1},
                                                     {1, 0.35F, 0, 1},
                                                     {1, 0.1F, 0.5F, 1},
                                                     {0.1F, 0.6F, 0.7F, 1}}};
  const Rgba& k = kDampened[static_cast<size_t>(hue)];
  return {static_cast<float>(value * (1 - colour * k.r)),
          static_cast<float>(value * (1 - colour * k.g)),
          static_cast<float>(value * (1 - colour * k.b)), 1};
}

Rgba Grey(double value) {
  const auto v = static_cast<float>(value);
  return {v, v, v, 1};
}

}  // namespace

Finishes DrawFinishes(BuildingKind kind, RoomUse use, const InteriorMaterials& m,
                      const Random& building, Random& random) {
  const auto pick = [&](const std::vector<MaterialId>& list) {
    return random.Pick(std::span<const MaterialId>(list));
  };
  Random house = building.Fork(7);
  Finishes f;
  const Rgba house_tint = DrawPaintTint(house);
  const bool white_wood = house.Chance(0.55);
  f.woodwork = {m.veneer, white_wood ? Grey(1) : Rgba{0.62F, 0.42F, 0.26F, 1}};
  if (white_wood) f.woodwork.material = m.plain;
  f.skirting = static_cast<float>(house.Uniform(0.05, 0.14));
  f.wall = {m.wall_paint, random.Chance(0.55) ? house_tint : DrawPaintTint(random)};
  f.ceiling = {m.wall_paint, Grey(random.Uniform(0.9, 1))};
  switch (kind) {
    case BuildingKind::kDwelling:
      f.floor = {random.Chance(0.75) ? pick(m.planks) : pick(m.carpets)};
      if (random.Chance(0.35)) f.wall = {pick(m.wallpapers)};
      if (random.Chance(0.06)) f.wall = {pick(m.bricks)};
      break;
    case BuildingKind::kOffice:
      f.floor = {random.Chance(0.6) ? pick(m.carpets)
                                    : pick(random.Chance(0.5) ? m.planks : m.terrazzos)};
      if (random.Chance(0.08)) f.wall = {random.Chance(0.5) ? m.concrete : pick(m.bricks)};
      break;
    case BuildingKind::kSchool:
      f.floor = {random.Chance(0.7) ? pick(m.terrazzos) : pick(m.floor_tiles)};
      if (random.Chance(0.5)) {
        f.lower_wall = {random.Chance(0.5) ? m.worn_paint : pick(m.wall_tiles),
                        DrawPaintTint(random)};
        f.lower_height = static_cast<float>(random.Uniform(1, 1.6));
      }
      break;
    case BuildingKind::kHall:
      f.floor = {random.Chance(0.75) ? m.screed : m.concrete, Grey(random.Uniform(0.7, 1))};
      f.wall = random.Chance(0.4)   ? Coat{m.concrete}
               : random.Chance(0.5) ? Coat{pick(m.bricks)}
                                    : Coat{m.worn_paint, DrawPaintTint(random)};
      f.ceiling = {random.Chance(0.5) ? m.concrete : m.worn_paint, Grey(random.Uniform(0.4, 0.9))};
      f.skirting = 0;
      break;
    case BuildingKind::kGarage:
      f.floor = {random.Chance(0.7) ? m.screed : m.asphalt, Grey(random.Uniform(0.7, 1))};
      f.wall = {random.Chance(0.6) ? m.concrete : m.worn_paint, Grey(random.Uniform(0.7, 1))};
      f.ceiling = {m.concrete, Grey(random.Uniform(0.8, 1))};
      if (random.Chance(0.6)) {
        f.lower_wall = {m.worn_paint, DrawPaintTint(random)};
        f.lower_height = static_cast<float>(random.Uniform(0.8, 1.4));
      }
      f.skirting = 0;
      break;
    case BuildingKind::kCellar:
      f.floor = random.Chance(0.4)   ? Coat{m.screed}
                : random.Chance(0.5) ? Coat{m.concrete}
                                     : Coat{m.setts};
      f.wall = random.Chance(0.4)   ? Coat{pick(m.bricks)}
               : random.Chance(0.4) ? Coat{m.ashlar}
                                    : Coat{m.worn_paint, Grey(random.Uniform(0.6, 0.95))};
      f.ceiling = f.wall;
      f.skirting = 0;
      break;
  }
  if (use == RoomUse::kBathroom || (use == RoomUse::kKitchen && random.Chance(0.6))) {
    f.floor = {pick(m.floor_tiles)};
    f.lower_wall = {pick(m.wall_tiles)};
    f.lower_height = static_cast<float>(use == RoomUse::kKitchen ? 1.5 : random.Uniform(1.2, 2.4));
    f.skirting = 0;
  }
  return f;
}

}  // namespace orb360::town
