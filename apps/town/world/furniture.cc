#include "apps/town/world/furniture.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace orb360::town {
namespace {

const Vector3f kUp(0, 0, 1);

/// Adds a whole box with sides along the axes.
void AddBlock(MeshBuilder& b, MaterialId material, const Vector3f& low, const Vector3f& high) {
  const Vector3f size = high - low;
  const Panel front{{high.x(), low.y(), low.z()}, {0, 1, 0}, kUp, {1, 0, 0}};
  b.AddBox(material, front, 0, size.y(), 0, size.z(), -size.x(), 0);
  const Panel back{{low.x(), high.y(), low.z()}, {0, -1, 0}, kUp, {-1, 0, 0}};
  b.AddRectangle(material, back, 0, size.y(), 0, size.z());
}

/// Adds a flat disc of `radius` that faces +y and -y.
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
  b.AddTube(materials.metal, {0, 0, -0.2F}, {0, 0, 0.9F}, 0.13F, 0.12F, 10);
  b.AddTube(materials.metal, {0, 0, 0.9F}, {0, 0, height}, 0.09F, 0.065F, 8);
  const float reach = 1.6F;
  b.AddTube(materials.metal, {0, 0, height}, {0.5F * reach, 0, height + 0.3F}, 0.065F, 0.06F, 6);
  b.AddTube(materials.metal, {0.5F * reach, 0, height + 0.3F}, {reach, 0, height + 0.35F}, 0.06F,
            0.06F, 6);
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
    b.AddImage(random.Pick(std::span<const MaterialId>(materials.signs)), plate, 0, 1.0F, 0, 0.25F);
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

Mesh MakePostBox(const Materials& materials) {
  MeshBuilder b(materials);
  const Rgba paint = Srgb(196, 150, 20);
  b.set_tint({0.1F, 0.1F, 0.1F, 1});
  b.AddTube(materials.metal, {0, 0, -0.1F}, {0, 0, 0.6F}, 0.055F, 0.055F, 8);
  b.set_tint(paint);
  AddBlock(b, materials.metal, {-0.17F, -0.24F, 0.6F}, {0.17F, 0.24F, 1.3F});
  AddBlock(b, materials.metal, {-0.2F, -0.27F, 1.3F}, {0.2F, 0.27F, 1.36F});
  b.set_tint({0.02F, 0.02F, 0.02F, 1});
  AddBlock(b, materials.trim, {-0.18F, -0.16F, 1.14F}, {0.18F, 0.16F, 1.18F});
  b.set_tint({0.75F, 0.75F, 0.72F, 1});
  AddBlock(b, materials.trim, {-0.175F, -0.12F, 0.85F}, {0.175F, 0.12F, 1.02F});
  return std::move(b.mesh());
}

Mesh MakeHydrant(const Materials& materials) {
  MeshBuilder b(materials);
  b.set_tint(Srgb(150, 30, 26));
  b.AddTube(materials.metal, {0, 0, -0.1F}, {0, 0, 0.55F}, 0.1F, 0.09F, 12);
  b.AddTube(materials.metal, {0, 0, 0.55F}, {0, 0, 0.6F}, 0.13F, 0.13F, 12);
  b.AddTube(materials.metal, {0, 0, 0.6F}, {0, 0, 0.72F}, 0.12F, 0.03F, 12);
  b.AddTube(materials.metal, {0, -0.19F, 0.42F}, {0, 0.19F, 0.42F}, 0.055F, 0.055F, 10);
  b.set_tint(Srgb(190, 190, 190));
  AddDisc(b, materials.trim, {0, 0.19F, 0.42F}, 0.055F);
  AddDisc(b, materials.trim, {0, -0.19F, 0.42F}, 0.055F);
  return std::move(b.mesh());
}

Mesh MakeCabinet(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  const auto shade = static_cast<float>(random.Uniform(0.15, 0.45));
  b.set_tint({0.9F * shade, shade, 0.88F * shade, 1});
  const auto width = static_cast<float>(random.Uniform(0.35, 0.7));
  const auto height = static_cast<float>(random.Uniform(1.0, 1.4));
  AddBlock(b, materials.trim, {-0.18F, -width, -0.1F}, {0.18F, width, height});
  b.set_tint({0.7F * shade, 0.7F * shade, 0.7F * shade, 1});
  AddBlock(b, materials.trim, {-0.21F, -width - 0.03F, height},
           {0.21F, width + 0.03F, height + 0.05F});
  b.set_tint({0.03F, 0.03F, 0.03F, 1});
  AddBlock(b, materials.trim, {0.17F, -0.006F, 0.05F}, {0.183F, 0.006F, height - 0.05F});
  b.set_tint({1, 1, 1, 1});
  const Panel front{{0.184F, -width, 0}, {0, 1, 0}, kUp, {1, 0, 0}};
  const MaterialId bill = random.Pick(std::span<const MaterialId>(materials.posters));
  b.AddImage(bill, front, 0.08F, 0.08F + 0.3F, 0.45F, 0.95F);
  return std::move(b.mesh());
}

Mesh MakeAdvertisingColumn(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  constexpr float kRadius = 0.42F;
  constexpr int kPosters = 4;
  constexpr int kSidesEach = 5;
  b.set_tint({0.35F, 0.35F, 0.34F, 1});
  b.AddTube(materials.concrete, {0, 0, -0.1F}, {0, 0, 0.4F}, 0.46F, 0.45F, 24);
  b.set_tint({1, 1, 1, 1});
  for (const float low : {0.4F, 1.65F}) {
    const float turn = static_cast<float>(random.Uniform(0, 6));
    for (int i = 0; i < kPosters; ++i) {
      const MaterialId poster = random.Pick(std::span<const MaterialId>(materials.posters));
      for (int k = 0; k < kSidesEach; ++k) {
        std::array<uint32_t, 4> index{};
        for (size_t c = 0; c < 4; ++c) {
          const bool right = c == 1 || c == 2;
          const float u = (static_cast<float>(k) + (right ? 1.0F : 0.0F)) / kSidesEach;
          const float a =
              turn + 2 * std::numbers::pi_v<float> * (static_cast<float>(i) + u) / kPosters;
          const Vector3f out(std::cos(a), std::sin(a), 0);
          index[c] = b.AddVertex(kRadius * out + (low + (c >= 2 ? 1.25F : 0.0F)) * kUp, out, u,
                                 c >= 2 ? 1.0F : 0.0F);
        }
        b.AddTriangle(poster, index[0], index[1], index[2]);
        b.AddTriangle(poster, index[0], index[2], index[3]);
      }
    }
  }
  b.set_tint({0.05F, 0.1F, 0.07F, 1});
  b.AddTube(materials.metal, {0, 0, 2.9F}, {0, 0, 3.05F}, 0.5F, 0.5F, 24);
  b.AddTube(materials.metal, {0, 0, 3.05F}, {0, 0, 3.4F}, 0.5F, 0.05F, 24);
  return std::move(b.mesh());
}

Mesh MakeBusShelter(const Materials& materials, Random random) {
  MeshBuilder b(materials);
  constexpr float kHalf = 1.8F;
  constexpr float kBack = -0.75F;
  constexpr float kHeight = 2.4F;
  b.set_tint({0.08F, 0.085F, 0.09F, 1});
  for (const float y : {-kHalf, 0.0F, kHalf}) {
    AddBlock(b, materials.metal, {kBack - 0.04F, y - 0.06F, -0.1F},
             {kBack + 0.04F, y + 0.06F, kHeight});
    AddBlock(b, materials.metal, {kBack, y - 0.03F, kHeight - 0.08F}, {0.2F, y + 0.03F, kHeight});
  }
  AddBlock(b, materials.metal, {kBack - 0.15F, -kHalf - 0.1F, kHeight},
           {0.3F, kHalf + 0.1F, kHeight + 0.1F});
  for (const float z : {0.3F, 1.2F})
    AddBlock(b, materials.metal, {kBack - 0.02F, -kHalf, z}, {kBack + 0.02F, kHalf, z + 0.05F});
  b.set_tint({0.3F, 0.17F, 0.09F, 1});
  AddBlock(b, materials.trim, {kBack + 0.1F, -1.2F, 0.44F}, {kBack + 0.42F, 0.4F, 0.48F});
  // The poster case at one end, lit on both sides, and the sign of the stop.
  b.set_tint({0.08F, 0.085F, 0.09F, 1});
  AddBlock(b, materials.metal, {kBack, kHalf - 0.06F, 0.2F}, {-0.05F, kHalf + 0.06F, 2.2F});
  b.set_tint({1, 1, 1, 1});
  const MaterialId poster = random.Pick(std::span<const MaterialId>(materials.posters));
  const Panel inner{{-0.1F, kHalf - 0.063F, 0.35F}, {-1, 0, 0}, kUp, {0, -1, 0}};
  const Panel outer{{kBack + 0.05F, kHalf + 0.063F, 0.35F}, {1, 0, 0}, kUp, {0, 1, 0}};
  b.AddImage(poster, inner, 0, 0.55F, 0, 1.7F);
  b.AddImage(poster, outer, 0, 0.55F, 0, 1.7F);
  const Panel name{{0.302F, -1.1F, kHeight - 0.01F}, {0, 1, 0}, kUp, {1, 0, 0}};
  b.AddImage(random.Pick(std::span<const MaterialId>(materials.signs)), name, 0, 2.2F, 0, 0.12F);
  return std::move(b.mesh());
}

}  // namespace orb360::town
