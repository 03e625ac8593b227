#include <algorithm>
#include <array>

#include "apps/town/world/facade.h"

namespace orb360::town {
namespace {

Rgba Pastel(Random& random) {
  static constexpr std::array<std::array<int, 3>, 14> kColours = {{{236, 226, 204},
                                                                   {228, 206, 160},
                                                                   {222, 188, 142},
                                                                   {214, 170, 140},
                                                                   {198, 146, 120},
                                                                   {206, 200, 188},
                                                                   {240, 236, 228},
                                                                   {186, 196, 200},
                                                                   {176, 190, 168},
                                                                   {232, 210, 190},
                                                                   {214, 196, 120},
                                                                   {172, 150, 132},
                                                                   {200, 160, 150},
                                                                   {244, 228, 180}}};
  const auto& c = kColours[static_cast<size_t>(random.Int(14))];
  const auto brightness = static_cast<float>(random.Uniform(0.75, 1.05));
  return brightness * Srgb(c[0], c[1], c[2]);
}

}  // namespace

FacadeStyle DrawFacadeStyle(Random& random, const Materials& m, float width) {
  FacadeStyle s;
  const double kind = random.Uniform();
  if (kind < 0.40) {
    s.wall = m.bricks[static_cast<size_t>(random.Int(static_cast<int>(m.bricks.size())))];
    const auto shade = static_cast<float>(random.Uniform(0.6, 1.0));
    s.wall_tint = {shade, shade * static_cast<float>(random.Uniform(0.9, 1.0)),
                   shade * static_cast<float>(random.Uniform(0.85, 1.0)), 1};
  } else if (kind < 0.85) {
    s.wall = m.plaster;
    s.wall_tint = Pastel(random);
  } else {
    s.wall = random.Chance(0.6) ? m.ashlar : m.concrete;
    s.wall_tint = Mix(Pastel(random), {1, 1, 1, 1}, 0.5F);
  }
  const bool stone_base = random.Chance(0.5);
  s.ground_wall = stone_base ? m.ashlar : s.wall;
  s.ground_tint =
      stone_base ? 0.85F * Mix(Pastel(random), {0.75F, 0.75F, 0.75F, 1}, 0.65F) : s.wall_tint;
  const auto trim = static_cast<float>(random.Uniform(0.55, 1.0));
  s.trim_tint = {trim, trim * 0.98F, trim * 0.93F, 1};
  static constexpr std::array<std::array<int, 3>, 6> kFrames = {
      {{245, 245, 240}, {240, 236, 220}, {90, 62, 44}, {60, 66, 70}, {44, 70, 56}, {130, 40, 34}}};
  const auto& frame = kFrames[static_cast<size_t>(random.Int(6))];
  s.frame_tint = Srgb(frame[0], frame[1], frame[2]);
  s.shutter_tint = Srgb(40 + random.Int(90), 50 + random.Int(90), 50 + random.Int(80));
  const double height_kind = random.Uniform();
  s.floors = height_kind < 0.25 ? 2 : (height_kind < 0.8 ? 3 + random.Int(3) : 5 + random.Int(4));
  if (width < 8) s.floors = std::min(s.floors, 4);
  s.ground_height = static_cast<float>(random.Uniform(3.3, 4.6));
  s.floor_height = static_cast<float>(random.Uniform(2.7, 3.5));
  s.bay = static_cast<float>(random.Uniform(2.2, 3.6));
  s.window_width = s.bay * static_cast<float>(random.Uniform(0.36, 0.62));
  s.window_height = s.floor_height * static_cast<float>(random.Uniform(0.48, 0.64));
  s.sill = s.floor_height * static_cast<float>(random.Uniform(0.22, 0.32));
  s.reveal = static_cast<float>(random.Uniform(0.08, 0.24));
  s.surrounds = random.Chance(0.55);
  s.shutters =
      s.wall == m.plaster && random.Chance(0.35) && s.bay - s.window_width > s.window_width + 0.1F;
  s.balconies = random.Chance(0.35);
  s.bands = random.Chance(0.5);
  s.quoins = random.Chance(0.3);
  s.shops = random.Chance(0.5);
  s.oriels = s.floors >= 3 && random.Chance(0.22);
  s.ivy = random.Chance(0.2);
  static constexpr std::array<BalconyKind, 4> kBalconies = {
      BalconyKind::kRailing, BalconyKind::kRailing, BalconyKind::kSolid, BalconyKind::kFrench};
  s.balcony = kBalconies[static_cast<size_t>(random.Int(4))];
  const double roof = random.Uniform();
  if (s.floors > 5 || roof < 0.2) {
    s.roof = roof < 0.8 ? RoofKind::kFlat : RoofKind::kMansard;
  } else {
    s.roof = roof < 0.6 ? RoofKind::kGable : (roof < 0.78 ? RoofKind::kHip : RoofKind::kMansard);
  }
  return s;
}

}  // namespace orb360::town
