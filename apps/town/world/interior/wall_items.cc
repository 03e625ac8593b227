#include "apps/town/world/interior/wall_items.h"

#include <algorithm>
#include <cmath>

#include "apps/town/world/interior/furniture.h"

namespace orb360::town {

void AddPicture(Kit& kit, const Panel& p, float x, float z, float width, float height) {
  const bool is_poster = kit.random.Chance(0.3);
  kit.b.set_tint({1, 1, 1, 1});
  if (is_poster) {
    kit.b.AddImage(kit.random.Chance(0.5) ? kit.Pick(kit.m.posters) : kit.Pick(kit.m.pictures), p,
                   x, x + width, z, z + height, 0.004F);
    return;
  }
  const float frame = kit.Draw(0.012, 0.05);
  kit.b.AddImage(kit.Pick(kit.m.pictures), p, x, x + width, z, z + height, 0.012F);
  const MaterialId wood = kit.Use(kit.random.Chance(0.5) ? kit.wood : kit.metal);
  const float deep = kit.Draw(0.018, 0.035);
  kit.b.AddBox(wood, p, x - frame, x + width + frame, z - frame, z, 0, deep);
  kit.b.AddBox(wood, p, x - frame, x + width + frame, z + height, z + height + frame, 0, deep);
  kit.b.AddBox(wood, p, x - frame, x, z, z + height, 0, deep);
  kit.b.AddBox(wood, p, x + width, x + width + frame, z, z + height, 0, deep);
}

void AddBoard(Kit& kit, const Panel& p, float x, float z, float width, float height) {
  AddSolid(kit.b, kit.UseGrey(0.5F), p, x, x + width, z, z + height, 0.005F, 0.02F);
  const int kind = kit.random.Int(3);
  if (kind == 0) kit.b.set_tint({0.04F, 0.09F, 0.06F, 1});
  if (kind == 1) kit.b.set_tint({0.9F, 0.9F, 0.9F, 1});
  if (kind == 2) kit.b.set_tint({0.4F, 0.24F, 0.12F, 1});
  kit.b.AddRectangle(kind == 2 ? kit.m.screed : kit.m.worn_paint, p, x + 0.02F, x + width - 0.02F,
                     z + 0.02F, z + height - 0.02F, 0.021F);
  if (kind != 2) {
    AddSolid(kit.b, kit.UseGrey(0.4F), p, x, x + width, z - 0.01F, z + 0.01F, 0.02F, 0.08F);
    return;
  }
  for (int i = static_cast<int>(width * 7); i > 0; --i) {
    const float w = kit.Draw(0.1, 0.3);
    const float h = std::min(height - 0.1F, kit.Draw(0.12, 0.42));
    const float left = kit.Draw(x + 0.03, std::max(x + 0.04F, x + width - w - 0.03F));
    const float low = kit.Draw(z + 0.03, std::max(z + 0.04F, z + height - h - 0.03F));
    kit.b.set_tint({1, 1, 1, 1});
    const MaterialId paper =
        kit.random.Chance(0.5) ? kit.Pick(kit.m.screens) : kit.Pick(kit.m.posters);
    kit.b.AddImage(paper, p, left, left + w, low, low + h,
                   0.022F + 0.0015F * static_cast<float>(i % 5));
  }
}

void AddRadiator(Kit& kit, const Panel& p, float x, float width, float height) {
  const MaterialId white = kit.UseGrey(0.8F);
  const float low = 0.12F;
  const int ribs = std::max(2, static_cast<int>(width / 0.06F));
  kit.b.AddBox(white, p, x, x + width, low, low + height, 0.04F, 0.085F);
  for (int i = 0; i < ribs; ++i) {
    const float left = x + width * static_cast<float>(i) / static_cast<float>(ribs);
    kit.b.AddBox(white, p, left + 0.008F, left + 0.045F, low + 0.03F, low + height - 0.03F, 0.085F,
                 0.1F);
  }
  for (const float at : {x - 0.03F, x + width + 0.03F})
    kit.b.AddTube(white, p.At(at, 0, 0.06F), p.At(at, low + 0.1F, 0.06F), 0.01F, 0.01F, 8);
}

void AddCurtain(Kit& kit, const Panel& p, float x0, float x1, float bottom, float top) {
  kit.b.set_tint({1, 1, 1, 1});
  const MaterialId cloth = kit.Use(kit.cloth);
  const float scale = kit.m[cloth].tiles_per_metre;
  const int count = std::max(8, static_cast<int>((x1 - x0) * 70));
  const float fold = kit.Draw(50, 80);  // radians a metre
  const float phase = kit.Draw(0, 6);
  const auto first = static_cast<uint32_t>(kit.b.mesh().positions.size());
  for (int i = 0; i <= count; ++i) {
    const float x = x0 + (x1 - x0) * static_cast<float>(i) / static_cast<float>(count);
    const float angle = fold * x + phase + std::sin(3 * x);
    const float depth = 0.09F + 0.028F * std::sin(angle);
    const Vector3f normal = (p.out - 0.028F * fold * std::cos(angle) * p.right).normalized();
    for (const float z : {bottom, top})
      kit.b.AddVertex(p.At(x, z, depth), normal, 1.6F * scale * x, scale * z);
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(count); ++i) {
    const uint32_t k = first + 2 * i;
    kit.b.AddTriangle(cloth, k, k + 2, k + 3);
    kit.b.AddTriangle(cloth, k, k + 3, k + 1);
  }
}

void AddSocket(Kit& kit, const Panel& p, float x, float z) {
  kit.b.AddBox(kit.UseGrey(0.85F), p, x - 0.04F, x + 0.04F, z - 0.04F, z + 0.04F, 0, 0.012F);
  kit.b.AddBox(kit.UseGrey(0.7F), p, x - 0.025F, x + 0.025F, z - 0.025F, z + 0.025F, 0.012F,
               0.016F);
}

bool AddPipes(Kit& kit, const Panel& p, float length, const PipeSpace& space) {
  bool has_branch = false;
  constexpr float kThickest = 0.12F;  // radius, metres
  float z = space.high - kit.Draw(0.08, 0.3);
  for (int i = 1 + kit.random.Int(4); i > 0 && z > space.low + kThickest; --i) {
    const float radius =
        kit.random.Chance(0.25) ? kit.Draw(0.07, kThickest) : kit.Draw(0.012, 0.045);
    const MaterialId colour =
        kit.random.Chance(0.6) ? kit.UseGrey(kit.Draw(0.2, 0.7)) : kit.UseColour();
    const float depth = radius + 0.05F;
    kit.b.AddTube(colour, p.At(0, z, depth), p.At(length, z, depth), radius, radius,
                  radius > 0.05F ? 18 : 10);
    for (float x = 0.4F; x < length; x += 1.7F)
      kit.b.AddTube(kit.UseGrey(0.3F), p.At(x, z, depth), p.At(x + 0.03F, z, depth),
                    radius + 0.006F, radius + 0.006F, 12);
    if (space.has_corner && kit.random.Chance(0.4)) {  // a branch to the floor
      has_branch = true;
      const float x = kit.Draw(0.05, 0.3);
      kit.b.AddTube(colour, p.At(x, 0, depth), p.At(x, z, depth), radius, radius, 12);
    }
    z -= 2 * radius + kit.Draw(0.05, 0.2);
  }
  return has_branch;
}

void AddRug(Kit& kit, const Panel& p, float width, float depth) {
  kit.b.set_tint({1, 1, 1, 1});
  const MaterialId cloth =
      kit.random.Chance(0.5) ? kit.Pick(kit.m.carpets) : kit.Pick(kit.m.cloths);
  kit.b.AddBox(cloth, {p.origin, p.right, -p.out, p.up}, 0, width, -depth, 0, 0.001F, 0.012F);
  kit.b.set_tint({0.5F, 0.4F, 0.35F, 1});
  kit.b.AddRectangle(kit.Pick(kit.m.cloths), {p.origin, p.right, -p.out, p.up}, 0.12F,
                     width - 0.12F, 0.12F - depth, -0.12F, 0.0135F);
}

}  // namespace orb360::town
