#include "apps/town/world/roof_fittings.h"

#include <cmath>
#include <span>

#include "apps/town/world/opening.h"

namespace orb360::town {

float HeightOver(const Profile& profile, float y) {
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto& [y0, z0] = profile[i];
    const auto& [y1, z1] = profile[i + 1];
    if (y >= y0 && y <= y1) return y1 > y0 ? std::lerp(z0, z1, (y - y0) / (y1 - y0)) : z1;
  }
  return 0;
}

void AddBlock(MeshBuilder& b, MaterialId material, const RoofFrame& f, float x0, float x1, float y0,
              float y1, float z0, float z1) {
  const Panel front = f.Front(0, y0, 0);
  b.AddBox(material, front, x0, x1, z0, z1, y0 - y1, 0);
  const Panel rear{f.At(0, y1, 0), -f.right, Vector3f::UnitZ(), f.back};
  b.AddRectangle(material, rear, -x1, -x0, z0, z1);
}

void AddChimney(MeshBuilder& b, const RoofFrame& f, float x, float y, float top, Random& random) {
  const Materials& m = b.materials();
  const auto width = static_cast<float>(random.Uniform(0.7, 1.5));
  constexpr float kDepth = 0.55F;  // metres
  const auto shade = static_cast<float>(random.Uniform(0.6, 0.95));
  b.set_tint({shade, shade, shade, 1});
  const MaterialId bricks = random.Pick(std::span<const MaterialId>(m.bricks));
  AddBlock(b, bricks, f, x, x + width, y, y + kDepth, 0, top);
  AddBlock(b, m.concrete, f, x - 0.06F, x + width + 0.06F, y - 0.06F, y + kDepth + 0.06F, top,
           top + 0.1F);
  const int pots = 1 + static_cast<int>(width / 0.42F);
  for (int i = 0; i < pots; ++i) {
    const float px = x + width * (static_cast<float>(i) + 0.5F) / static_cast<float>(pots);
    const Vector3f foot = f.At(px, y + 0.5F * kDepth, top + 0.1F);
    b.set_tint({0.42F, 0.17F, 0.09F, 1});
    b.AddTube(m.trim, foot, foot + 0.42F * Vector3f::UnitZ(), 0.12F, 0.1F, 8);
    b.set_tint({0.02F, 0.02F, 0.02F, 1});
    b.AddTube(m.trim, foot + 0.4F * Vector3f::UnitZ(), foot + 0.41F * Vector3f::UnitZ(), 0.11F,
              0.001F, 8);
  }
}

void AddAerial(MeshBuilder& b, const RoofFrame& f, float x, float y, float z) {
  const MaterialId metal = b.materials().metal;
  b.set_tint({0.25F, 0.25F, 0.26F, 1});
  constexpr float kMast = 1.8F;  // metres
  b.AddTube(metal, f.At(x, y, z), f.At(x, y, z + kMast), 0.02F, 0.02F, 4);
  b.AddTube(metal, f.At(x, y - 0.5F, z + kMast - 0.1F), f.At(x, y + 0.5F, z + kMast - 0.1F), 0.012F,
            0.012F, 4);
  for (float along = -0.45F; along < 0.5F; along += 0.22F) {
    const float half = 0.28F - 0.16F * along;
    b.AddTube(metal, f.At(x - half, y + along, z + kMast - 0.1F),
              f.At(x + half, y + along, z + kMast - 0.1F), 0.008F, 0.008F, 4);
  }
}

void AddDormer(MeshBuilder& b, const RoofFrame& f, const FacadeStyle& style, MaterialId tiles,
               const Rgba& tile_tint, const Profile& profile, float x, float y, float height,
               Random& random) {
  const Materials& m = b.materials();
  constexpr float kWidth = 1.25F;  // metres
  const float foot = HeightOver(profile, y);
  const float top = foot + height;
  // The position where the slope reaches the dormer's eaves, or almost the ridge.
  float end = y;
  while (end < 0.5F * f.depth - 0.1F && HeightOver(profile, end) < top) end += 0.05F;
  const Panel front = f.Front(x, y, foot);
  const Opening opening{0.14F, kWidth - 0.14F, 0.18F, height - 0.12F};
  AddWallWithOpening(b, m.trim, style.trim_tint, front, {0, kWidth, -0.3F, height}, opening, 0.08F);
  AddWindow(b, style.frame_tint, front, opening, 0.08F, true,
            random.Pick(std::span<const MaterialId>(m.rooms)), random);
  b.set_tint(0.8F * tile_tint);
  const auto at = [&](float dx, float dy, float z) { return f.At(x + dx, dy, z); };
  const float slope = HeightOver(profile, end);
  b.AddFace(tiles, at(0, end, slope), at(0, y, foot - 0.3F), at(0, y, top), at(0, end, top));
  b.AddFace(tiles, at(kWidth, y, foot - 0.3F), at(kWidth, end, slope), at(kWidth, end, top),
            at(kWidth, y, top));
  // A small gable of its own, whose ridge runs back into the slope.
  constexpr float kRise = 0.45F;
  constexpr float kEave = 0.12F;
  float back = end;
  while (back < 0.5F * f.depth - 0.05F && HeightOver(profile, back) < top + kRise) back += 0.05F;
  b.set_tint(tile_tint);
  const float middle = 0.5F * kWidth;
  b.AddFace(tiles, at(middle, y - 0.2F, top + kRise), at(-kEave, y - 0.2F, top - 0.08F),
            at(-kEave, end, top - 0.08F), at(middle, back, top + kRise));
  b.AddFace(tiles, at(kWidth + kEave, y - 0.2F, top - 0.08F), at(middle, y - 0.2F, top + kRise),
            at(middle, back, top + kRise), at(kWidth + kEave, end, top - 0.08F));
  b.set_tint(style.trim_tint);
  b.AddFace(m.trim, at(0, y - 0.01F, top), at(kWidth, y - 0.01F, top),
            at(middle, y - 0.01F, top + kRise - 0.05F), at(middle, y - 0.01F, top + kRise - 0.05F));
}

void AddSkylight(MeshBuilder& b, const RoofFrame& f, const Profile& profile, float x, float y,
                 Random& random) {
  const Vector3f foot = f.At(x, y, HeightOver(profile, y));
  const Vector3f head = f.At(x, y + 0.8F, HeightOver(profile, y + 0.8F));
  const Vector3f up = (head - foot).normalized();
  const Panel panel{foot, f.right, up, f.right.cross(up)};
  const float length = (head - foot).norm();
  b.set_tint({0.1F, 0.1F, 0.1F, 1});
  b.AddBox(b.materials().trim, panel, -0.06F, 0.76F, -0.06F, length + 0.06F, 0, 0.07F);
  AddPane(b, random.Pick(std::span<const MaterialId>(b.materials().rooms)), panel,
          {0, 0.7F, 0, length}, 0.075F, random);
}

}  // namespace orb360::town
