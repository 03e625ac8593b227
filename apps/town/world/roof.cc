#include "apps/town/world/roof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "apps/town/world/roof_fittings.h"

namespace orb360::town {
namespace {

constexpr float kFrontOverhang = 0.4F;  // metres, over the eaves at front and back

void AddGutter(MeshBuilder& b, const Vector3f& from, const Vector3f& to) {
  b.set_tint({0.2F, 0.2F, 0.2F, 1});
  b.AddTube(b.materials().metal, from, to, 0.075F, 0.075F, 6);
}

/// Adds slopes along the front with walls below them at the sides.
void AddProfileRoof(MeshBuilder& b, const FacadeStyle& style, const RoofFrame& f, MaterialId tiles,
                    const Rgba& tint, const Profile& profile) {
  b.set_tint(tint);
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto& [y0, z0] = profile[i];
    const auto& [y1, z1] = profile[i + 1];
    b.AddFace(tiles, f.At(0, y0, z0), f.At(f.width, y0, z0), f.At(f.width, y1, z1),
              f.At(0, y1, z1));
  }
  b.set_tint(style.wall_tint);
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    const float y0 = std::clamp(profile[i][0], 0.0F, f.depth);
    const float y1 = std::clamp(profile[i + 1][0], 0.0F, f.depth);
    if (y1 - y0 < 1e-3F) continue;
    const float z0 = HeightOver(profile, y0);
    const float z1 = HeightOver(profile, y1);
    b.AddFace(style.wall, f.At(0, y1, -0.1F), f.At(0, y0, -0.1F), f.At(0, y0, z0), f.At(0, y1, z1));
    b.AddFace(style.wall, f.At(f.width, y0, -0.1F), f.At(f.width, y1, -0.1F), f.At(f.width, y1, z1),
              f.At(f.width, y0, z0));
  }
  const auto ridge = *std::max_element(profile.begin(), profile.end(),
                                       [](const auto& p, const auto& q) { return p[1] < q[1]; });
  b.set_tint(0.7F * tint);
  b.AddTube(tiles, f.At(0, ridge[0], ridge[1]), f.At(f.width, ridge[0], ridge[1]), 0.1F, 0.1F, 6);
  for (const auto& [y, z] : {profile.front(), profile.back()})
    AddGutter(b, f.At(0, y, z - 0.03F), f.At(f.width, y, z - 0.03F));
}

void AddHipRoof(MeshBuilder& b, const RoofFrame& f, MaterialId tiles, const Rgba& tint,
                float rise) {
  constexpr float kOverhang = 0.2F;  // metres: less than elsewhere, for it reaches over the sides
  const float inset = std::min(0.5F * f.depth, 0.5F * f.width);
  const float fall = kOverhang * rise / (0.5F * f.depth);
  const float side = kOverhang * inset / (0.5F * f.depth);  // all slopes start on the walls
  const std::array<Vector3f, 4> eaves = {
      f.At(-side, -kOverhang, -fall), f.At(f.width + side, -kOverhang, -fall),
      f.At(f.width + side, f.depth + kOverhang, -fall), f.At(-side, f.depth + kOverhang, -fall)};
  const Vector3f left = f.At(inset, 0.5F * f.depth, rise);
  const Vector3f right = f.At(f.width - inset, 0.5F * f.depth, rise);
  b.set_tint(tint);
  b.AddFace(tiles, eaves[0], eaves[1], right, left);
  b.AddFace(tiles, eaves[1], eaves[2], right, right);
  b.AddFace(tiles, eaves[2], eaves[3], left, right);
  b.AddFace(tiles, eaves[3], eaves[0], left, left);
  b.set_tint(0.7F * tint);
  for (const auto& [from, to] : {std::pair(eaves[0], left),
                                 {eaves[3], left},
                                 {eaves[1], right},
                                 {eaves[2], right},
                                 {left, right}}) {
    if ((to - from).norm() > 0.1F) b.AddTube(tiles, from, to, 0.09F, 0.09F, 6);
  }
  for (size_t i = 0; i < 4; ++i) AddGutter(b, eaves[i], eaves[(i + 1) % 4]);
}

void AddFlatRoof(MeshBuilder& b, const FacadeStyle& style, const RoofFrame& f, Random& random) {
  const Materials& m = b.materials();
  const auto parapet = static_cast<float>(random.Uniform(0.5, 1.1));
  constexpr float kThickness = 0.3F;
  b.set_tint({1, 1, 1, 1});
  b.AddFace(m.gravel, f.At(0, 0, 0), f.At(f.width, 0, 0), f.At(f.width, f.depth, 0),
            f.At(0, f.depth, 0));
  const float w = f.width;
  const float d = f.depth;
  const std::array<std::array<float, 4>, 4> walls = {
      {{0, w, 0, kThickness},
       {0, w, d - kThickness, d},
       {0, kThickness, kThickness, d - kThickness},
       {w - kThickness, w, kThickness, d - kThickness}}};
  for (const auto& [x0, x1, y0, y1] : walls) {
    b.set_tint(style.wall_tint);
    AddBlock(b, style.wall, f, x0, x1, y0, y1, 0, parapet);
    b.set_tint(0.9F * style.trim_tint);
    AddBlock(b, m.concrete, f, x0 - 0.03F, x1 + 0.03F, y0 - 0.05F, y1 + 0.05F, parapet,
             parapet + 0.07F);
  }
  // The top of the stairs, ventilators and a tank.
  if (w > 7) {
    const auto x = static_cast<float>(random.Uniform(0.2, 0.6)) * w;
    b.set_tint(0.9F * style.wall_tint);
    AddBlock(b, style.wall, f, x, x + 2.6F, 0.45F * d, 0.45F * d + 3, 0, 2.5F);
  }
  const int boxes = random.Int(4);
  for (int i = 0; i < boxes; ++i) {
    const auto x = static_cast<float>(random.Uniform(0.1, 0.85)) * w;
    const auto y = static_cast<float>(random.Uniform(0.1, 0.7)) * d;
    const auto size = static_cast<float>(random.Uniform(0.6, 1.3));
    b.set_tint({0.5F, 0.5F, 0.5F, 1});
    AddBlock(b, m.trim, f, x, x + size, y, y + size, 0, 0.8F * size);
  }
}

}  // namespace

void AddRoof(MeshBuilder& b, const FacadeStyle& style, const Lot& lot, Random& random) {
  const Materials& m = b.materials();
  const Vector3f up(0, 0, 1);
  constexpr float kWallPlate = 0.08F;  // metres above the eaves
  const RoofFrame f{lot.front_left + (EavesHeight(style) + kWallPlate) * up, lot.right,
                    up.cross(lot.right), lot.width, lot.depth};
  const float d = f.depth;
  const bool slate = random.Chance(style.roof == RoofKind::kMansard ? 0.8 : 0.35);
  const MaterialId tiles = slate ? m.slates : m.roof_tiles;
  const auto shade = static_cast<float>(random.Uniform(0.55, 1.0));
  const Rgba tint{shade, shade * static_cast<float>(random.Uniform(0.8, 1)),
                  shade * static_cast<float>(random.Uniform(0.75, 1)), 1};
  Profile profile;
  if (style.roof == RoofKind::kGable || style.roof == RoofKind::kHip) {
    const float rise = d * static_cast<float>(random.Uniform(0.26, 0.46));
    const float fall = kFrontOverhang * rise / (0.5F * d);
    profile = {{-kFrontOverhang, -fall}, {0.5F * d, rise}, {d + kFrontOverhang, -fall}};
    if (style.roof == RoofKind::kGable)
      AddProfileRoof(b, style, f, tiles, tint, profile);
    else
      AddHipRoof(b, f, tiles, tint, rise);
  } else if (style.roof == RoofKind::kMansard) {
    const auto steep = static_cast<float>(random.Uniform(2.2, 2.8));
    profile = {
        {-0.1F, 0}, {0.8F, steep}, {0.5F * d, steep + 0.9F}, {d - 0.8F, steep}, {d + 0.1F, 0}};
    AddProfileRoof(b, style, f, tiles, tint, profile);
  } else {
    AddFlatRoof(b, style, f, random);
    profile = {{0, 0}, {d, 0}};
  }

  const bool mansard = style.roof == RoofKind::kMansard;
  const bool steep_gable =
      style.roof == RoofKind::kGable && HeightOver(profile, 0.5F * d) > 0.34F * d;
  if (mansard || (steep_gable && random.Chance(0.6))) {
    const float y = mansard ? 0.12F : 0.16F * d;
    const float height = mansard ? 1.6F : 1.25F;
    const int count = std::max(1, static_cast<int>(f.width / random.Uniform(2.4, 4.5)));
    const float step = f.width / static_cast<float>(count);
    for (int i = 0; i < count; ++i) {
      const float x = step * (static_cast<float>(i) + 0.5F) - 0.62F;
      AddDormer(b, f, style, tiles, tint, profile, x, y, height, random);
    }
  } else if (style.roof == RoofKind::kGable) {
    const int count = random.Int(4);
    for (int i = 0; i < count; ++i) {
      const auto x = static_cast<float>(random.Uniform(0.08, 0.85)) * f.width;
      AddSkylight(b, f, profile, x, 0.2F * d, random);
    }
  }
  const int chimneys = style.roof == RoofKind::kFlat ? random.Int(2) : 1 + random.Int(2);
  for (int i = 0; i < chimneys; ++i) {
    const auto x =
        static_cast<float>(i == 0 ? random.Uniform(0.02, 0.1) : random.Uniform(0.6, 0.85)) *
        f.width;
    const auto y = static_cast<float>(random.Uniform(0.42, 0.56)) * d;
    const float top = HeightOver(profile, 0.5F * d) + static_cast<float>(random.Uniform(0.9, 1.7));
    AddChimney(b, f, x, y, top, random);
  }
  if (random.Chance(0.45)) {
    const auto x = static_cast<float>(random.Uniform(0.2, 0.8)) * f.width;
    AddAerial(b, f, x, 0.5F * d, HeightOver(profile, 0.5F * d) - 0.1F);
  }
}

}  // namespace orb360::town
