#include "apps/town/world/interior/kit.h"

#include <array>
#include <cmath>
#include <numbers>

namespace orb360::town {

MaterialId Kit::UseColour() {
  const float grey = Draw(0.02, 0.7);
  const Rgba colour{Draw(0.02, 0.7), Draw(0.02, 0.7), Draw(0.02, 0.7), 1};
  b.set_tint(Mix({grey, grey, grey, 1}, colour, Draw(0.1, 0.9)));
  return m.plain;
}

Kit MakeKit(MeshBuilder& b, const InteriorMaterials& m, Random& random) {
  static constexpr std::array<Rgba, 7> kWoods = {{{0.75F, 0.55F, 0.34F, 1},
                                                  {0.5F, 0.32F, 0.18F, 1},
                                                  {0.26F, 0.15F, 0.09F, 1},
                                                  {0.85F, 0.74F, 0.56F, 1},
                                                  {0.6F, 0.36F, 0.2F, 1},
                                                  {0.13F, 0.1F, 0.09F, 1},
                                                  {0.9F, 0.88F, 0.84F, 1}}};
  Kit kit{b, m, random, {}, {}, {}, {}};
  const auto wood = [&] { return Coat{m.veneer, random.Pick(std::span<const Rgba>(kWoods))}; };
  kit.wood = wood();
  kit.second = random.Chance(0.4) ? kit.wood : wood();
  if (random.Chance(0.4)) {
    const float v = kit.Draw(0.1, 1);
    kit.second = {m.plain, {v, v * kit.Draw(0.85, 1), v * kit.Draw(0.75, 1.05), 1}};
  }
  kit.cloth = {kit.Pick(m.cloths)};
  const float steel = kit.Draw(0.03, 0.6);
  kit.metal = {m.plain, {steel, steel, steel * 1.02F, 1}};
  return kit;
}

Panel Turned(const Panel& p, float x, float depth, float angle, float z) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  // Right, out and up are a right-handed frame in the order out, right, up.
  return {p.At(x, z, depth), c * p.right - s * p.out, p.up, c * p.out + s * p.right};
}

void AddSolid(MeshBuilder& b, MaterialId material, const Panel& p, float x0, float x1, float z0,
              float z1, float depth0, float depth1) {
  b.AddBox(material, p, x0, x1, z0, z1, depth0, depth1);
  b.AddFace(material, p.At(x1, z0, depth0), p.At(x0, z0, depth0), p.At(x0, z1, depth0),
            p.At(x1, z1, depth0));
  b.AddFace(material, p.At(x0, z0, depth0), p.At(x1, z0, depth0), p.At(x1, z0, depth1),
            p.At(x0, z0, depth1));
}

void AddCushion(MeshBuilder& b, MaterialId material, const Panel& p, float x0, float x1, float z0,
                float z1, float depth0, float depth1) {
  constexpr int kRings = 10;
  constexpr int kSides = 20;
  constexpr float kPower = 0.38F;  // 1: an ellipsoid, 0: a box
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto bend = [](float x) { return std::copysign(std::pow(std::abs(x), kPower), x); };
  const auto slope = [](float x) { return std::copysign(std::pow(std::abs(x), 2 - kPower), x); };
  const Vector3f radii(0.5F * (x1 - x0), 0.5F * (z1 - z0), 0.5F * (depth1 - depth0));
  const Vector3f centre(0.5F * (x0 + x1), 0.5F * (z0 + z1), 0.5F * (depth0 + depth1));
  const auto world = [&](const Vector3f& v) -> Vector3f {
    return v.x() * p.right + v.y() * p.up + v.z() * p.out;
  };
  const float scale = b.materials()[material].tiles_per_metre;
  const auto first = static_cast<uint32_t>(b.mesh().positions.size());
  for (int i = 0; i <= kRings; ++i) {
    const float latitude = kPi * (static_cast<float>(i) / kRings - 0.5F);
    for (int k = 0; k <= kSides; ++k) {
      const float longitude = 2 * kPi * static_cast<float>(k) / kSides;
      const Vector3f d(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                       -std::cos(latitude) * std::sin(longitude));
      const float cl = bend(std::cos(latitude));
      const Vector3f place(cl * bend(std::cos(longitude)) * radii.x(), bend(d.y()) * radii.y(),
                           -cl * bend(std::sin(longitude)) * radii.z());
      const float nl = slope(std::cos(latitude));
      const Vector3f normal =
          Vector3f(nl * slope(std::cos(longitude)) / radii.x(), slope(d.y()) / radii.y(),
                   -nl * slope(std::sin(longitude)) / radii.z())
              .normalized();
      // Cloth is projected from above, and from the side where the surface is steep.
      const Vector3f at = centre + place;
      b.AddVertex(p.origin + world(at), world(normal), scale * (at.x() + 0.4F * at.z()),
                  scale * (at.y() + 0.9F * at.z()));
    }
  }
  for (uint32_t i = 0; i < kRings; ++i) {
    for (uint32_t k = 0; k < kSides; ++k) {
      const uint32_t a = first + i * (kSides + 1) + k;
      b.AddTriangle(material, a, a + 1, a + kSides + 2);
      b.AddTriangle(material, a, a + kSides + 2, a + kSides + 1);
    }
  }
}

void AddDrum(MeshBuilder& b, MaterialId material, const Vector3f& foot, float radius, float height,
             int sides) {
  const Vector3f top = foot + height * Vector3f::UnitZ();
  b.AddTube(material, foot, top, radius, radius, sides);
  std::vector<Vector3f> rim;
  for (int i = 0; i < sides; ++i) {
    const float angle =
        2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
    rim.push_back(top + radius * Vector3f(std::cos(angle), std::sin(angle), 0));
  }
  b.AddGroundPolygon(material, rim);
}

void AddLegs(Kit& kit, const Coat& coat, const Panel& p, float x0, float x1, float depth0,
             float depth1, float height, float side) {
  const MaterialId material = kit.Use(coat);
  for (const float x : {x0, x1 - side}) {
    for (const float depth : {depth0, depth1 - side})
      AddSolid(kit.b, material, p, x, x + side, 0, height, depth, depth + side);
  }
}

}  // namespace orb360::town
