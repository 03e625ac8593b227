#include "apps/town/world/furniture.h"

#include <cmath>
#include <numbers>
#include <span>

namespace orb360::town {
namespace {

const Vector3f kUp(0, 0, 1);

/// A whole box, sides along the axes.
void AddBlock(MeshBuilder& b, MaterialId material, const Vector3f& low, const Vector3f& high) {
  const Vector3f size = high - low;
  const Panel front{{high.x(), low.y(), low.z()}, {0, 1, 0}, kUp, {1, 0, 0}};
  b.AddBox(material, front, 0, size.y(), 0, size.z(), -size.x(), 0);
  const Panel back{{low.x(), high.y(), low.z()}, {0, -1, 0}, kUp, {-1, 0, 0}};
  b.AddRectangle(material, back, 0, size.y(), 0, size.z());
}

/// A flat disc of `radius` facing +y and -y.
void AddDisc(MeshBuilder& b, MaterialId material, const Vector3f& centre, float radius) {
  constexpr int kSides = 20;
  for (int i = 0; i < kSides; ++i) {
    const auto at = [&](int k) {
      const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSides;
      return Vector3f(centre + radius * Vector3f(std::cos(a), 0, std::sin(a)));
    };
    b.AddFace(material, centre, at(i + 1), at(i), centre);
  }
}

}  // namespace

Mesh MakeLampPost(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  const auto height = static_cast<float>(random.Uniform(5, 8));
  b.set_tint(random.Chance(0.5) ? Rgba{0.05F, 0.07F, 0.06F, 1} : Rgba{0.3F, 0.31F, 0.32F, 1});
  b.AddTube(materials.metal, {0, 0, -0.2F}, {0, 0, 0.9F}, 0.11F, 0.1F, 10);
  b.AddTube(materials.metal, {0, 0, 0.9F}, {0, 0, height}, 0.065F, 0.045F, 8);
  const float reach = 1.6F;
  b.AddTube(materials.metal, {0, 0, height}, {0.5F * reach, 0, height + 0.3F}, 0.045F, 0.04F, 6);
  b.AddTube(materials.metal, {0.5F * reach, 0, height + 0.3F}, {reach, 0, height + 0.35F}, 0.04F,
            0.04F, 6);
  AddBlock(b, materials.metal, {reach - 0.1F, -0.14F, height + 0.3F},
           {reach + 0.6F, 0.14F, height + 0.42F});
  b.set_tint({0.9F, 0.88F, 0.8F, 1});
  AddBlock(b, materials.lamp, {reach, -0.11F, height + 0.27F},
           {reach + 0.55F, 0.11F, height + 0.3F});
  return std::move(b.mesh());
}

Mesh MakeTrafficLight(const Materials& materials) {
  MeshBuilder b(materials);
  b.set_tint({0.08F, 0.08F, 0.08F, 1});
  b.AddTube(materials.metal, {0, 0, -0.2F}, {0, 0, 3.3F}, 0.06F, 0.055F, 8);
  AddBlock(b, materials.metal, {-0.16F, 0.06F, 2.3F}, {0.16F, 0.3F, 3.25F});
  const std::array<Rgba, 3> colours = {
      {{0.05F, 0.5F, 0.15F, 1}, {0.15F, 0.1F, 0.02F, 1}, {0.12F, 0.02F, 0.02F, 1}}};
  for (size_t i = 0; i < 3; ++i) {
    b.set_tint(colours[i]);
    AddDisc(b, materials.lamp, {0, 0.31F, 2.47F + 0.3F * static_cast<float>(i)}, 0.11F);
  }
  return std::move(b.mesh());
}

Mesh MakeRoadSign(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  b.set_tint({0.4F, 0.41F, 0.42F, 1});
  b.AddTube(materials.metal, {0, 0, -0.2F}, {0, 0, 2.9F}, 0.035F, 0.035F, 8);
  const int kind = random.Int(3);
  if (kind == 0) {
    b.set_tint({0.5F, 0.02F, 0.02F, 1});
    AddDisc(b, materials.trim, {0, 0.045F, 2.6F}, 0.32F);
    b.set_tint({0.85F, 0.85F, 0.85F, 1});
    AddDisc(b, materials.trim, {0, 0.05F, 2.6F}, 0.24F);
    b.set_tint({0.03F, 0.03F, 0.03F, 1});
    AddBlock(b, materials.trim, {-0.1F, 0.05F, 2.5F}, {-0.02F, 0.055F, 2.7F});
    AddBlock(b, materials.trim, {0.03F, 0.05F, 2.5F}, {0.12F, 0.055F, 2.7F});
  } else if (kind == 1) {
    b.set_tint({0.03F, 0.12F, 0.45F, 1});
    AddDisc(b, materials.trim, {0, 0.045F, 2.6F}, 0.32F);
    b.set_tint({0.85F, 0.85F, 0.85F, 1});
    AddBlock(b, materials.trim, {-0.05F, 0.05F, 2.42F}, {0.05F, 0.055F, 2.78F});
  } else {
    b.set_tint({1, 1, 1, 1});
    const Panel plate{{0.5F, 0.05F, 2.5F}, {-1, 0, 0}, kUp, {0, 1, 0}};
    b.AddPicture(random.Pick(std::span<const MaterialId>(materials.signs)), plate, 0, 1.0F, 0,
                 0.25F);
  }
  return std::move(b.mesh());
}

Mesh MakeBench(const Materials& materials) {
  MeshBuilder b(materials);
  b.set_tint({0.28F, 0.15F, 0.07F, 1});
  for (int i = 0; i < 3; ++i) {
    const float x = 0.12F * static_cast<float>(i);
    AddBlock(b, materials.trim, {x - 0.2F, -0.8F, 0.43F}, {x - 0.1F, 0.8F, 0.47F});
  }
  for (int i = 0; i < 2; ++i) {
    const float z = 0.6F + 0.14F * static_cast<float>(i);
    AddBlock(b, materials.trim, {-0.27F, -0.8F, z}, {-0.24F, 0.8F, z + 0.1F});
  }
  b.set_tint({0.05F, 0.05F, 0.05F, 1});
  for (const float y : {-0.65F, 0.65F}) {
    AddBlock(b, materials.metal, {-0.2F, y - 0.03F, 0}, {0.12F, y + 0.03F, 0.43F});
    AddBlock(b, materials.metal, {-0.25F, y - 0.03F, 0.4F}, {-0.2F, y + 0.03F, 0.85F});
  }
  return std::move(b.mesh());
}

Mesh MakeBin(const Materials& materials) {
  MeshBuilder b(materials);
  b.set_tint({0.06F, 0.14F, 0.08F, 1});
  b.AddTube(materials.metal, {0, 0, 0}, {0, 0, 0.85F}, 0.2F, 0.24F, 14);
  b.set_tint({0.02F, 0.02F, 0.02F, 1});
  b.AddTube(materials.metal, {0, 0, 0.85F}, {0, 0, 0.9F}, 0.24F, 0.02F, 14);
  return std::move(b.mesh());
}

Mesh MakeBollard(const Materials& materials) {
  MeshBuilder b(materials);
  b.set_tint({0.07F, 0.07F, 0.075F, 1});
  b.AddTube(materials.metal, {0, 0, -0.1F}, {0, 0, 0.9F}, 0.06F, 0.055F, 10);
  b.AddTube(materials.metal, {0, 0, 0.9F}, {0, 0, 0.98F}, 0.075F, 0.01F, 10);
  b.set_tint({0.8F, 0.8F, 0.8F, 1});
  b.AddTube(materials.metal, {0, 0, 0.7F}, {0, 0, 0.8F}, 0.059F, 0.058F, 10);
  return std::move(b.mesh());
}

}  // namespace orb360::town
