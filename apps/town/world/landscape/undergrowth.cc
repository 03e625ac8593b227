#include "apps/town/world/landscape/undergrowth.h"

#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "apps/town/world/plant_card.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float Draw(Random& random, double low, double high) {
  return static_cast<float>(random.Uniform(low, high));
}

Vector3f Level(float angle) { return {std::cos(angle), std::sin(angle), 0}; }

}  // namespace

Mesh MakeFern(const LandscapeMaterials& materials, Random random) {
  MeshBuilder b(materials);
  const MaterialId frond = random.Pick(std::span<const MaterialId>(materials.ferns));
  const int count = 7 + random.Int(5);
  const float size = Draw(random, 0.55, 1.1);
  for (int i = 0; i < count; ++i) {
    const float angle =
        2 * kPi * (static_cast<float>(i) + Draw(random, -0.3, 0.3)) / static_cast<float>(count);
    const Vector3f out = Level(angle);
    const Vector3f along = (out + Draw(random, 0.7, 1.6) * Vector3f::UnitZ()).normalized();
    const float length = size * Draw(random, 0.8, 1.1);
    const float shade = Draw(random, 0.65, 1);
    b.set_tint({shade, shade, shade, 1});
    AddPlantCard({.root = 0.03F * out,
                  .along = along,
                  .across = Level(angle + kPi / 2),
                  .length = length,
                  .width = 0.55F * length,
                  .droop = 0.45F * length,
                  .light = (0.3F * out + Vector3f::UnitZ()).normalized()},
                 frond, b);
  }
  return std::move(b.mesh());
}

Mesh MakeGrass(const LandscapeMaterials& materials, bool is_dry, Random random) {
  MeshBuilder b(materials);
  const auto& tufts = is_dry ? materials.dry_tufts : materials.grass_tufts;
  const int count = 9 + random.Int(9);
  const float height = Draw(random, 0.2, 0.55);
  for (int i = 0; i < count; ++i) {
    const MaterialId tuft = random.Pick(std::span<const MaterialId>(tufts));
    const Vector3f root = 0.5F * std::sqrt(Draw(random, 0, 1)) * Level(Draw(random, 0, 2 * kPi)) -
                          Vector3f(0, 0, 0.03F);
    const float turn = Draw(random, 0, kPi);
    const float size = height * Draw(random, 0.7, 1.2);
    const float shade = Draw(random, 0.6, 1);
    b.set_tint({shade, shade, shade, 1});
    const Vector3f lean(Draw(random, -0.2, 0.2), Draw(random, -0.2, 0.2), 1);
    for (const float angle : {turn, turn + kPi / 2})
      AddPlantCard({.root = root,
                    .along = lean.normalized(),
                    .across = Level(angle),
                    .length = size,
                    .width = 1.1F * size},
                   tuft, b);
  }
  return std::move(b.mesh());
}

Mesh MakeShrub(const LandscapeMaterials& materials, Random random) {
  MeshBuilder b(materials);
  const MaterialId leaves = random.Pick(std::span<const MaterialId>(materials.leaves));
  const float height = Draw(random, 0.7, 1.8);
  const int stems = 5 + random.Int(5);
  const float green = Draw(random, 0.7, 1);
  for (int i = 0; i < stems; ++i) {
    const Vector3f out = Level(Draw(random, 0, 2 * kPi));
    const Vector3f along = (Draw(random, 0.1, 0.7) * out + Vector3f::UnitZ()).normalized();
    const float length = height * Draw(random, 0.6, 1);
    b.set_tint({0.6F, 0.55F, 0.5F, 1});
    b.AddTube(materials.bark, Vector3f(0, 0, -0.05F), length * along, 0.014F, 0.004F, 4);
    for (int k = 0; k < 9; ++k) {
      const float t = Draw(random, 0.25, 1);
      const float turn = Draw(random, 0, 2 * kPi);
      const Vector3f side =
          (Level(turn) + Draw(random, -0.2, 0.8) * Vector3f::UnitZ()).normalized();
      const float size = Draw(random, 0.22, 0.42);
      const float shade = green * Draw(random, 0.6, 1);
      b.set_tint({shade, shade, 0.8F * shade, 1});
      AddPlantCard({.root = t * length * along,
                    .along = side,
                    .across = Level(turn + kPi / 2),
                    .length = size,
                    .width = size,
                    .droop = 0.15F * size,
                    .light = (0.5F * side + Vector3f::UnitZ()).normalized()},
                   leaves, b);
    }
  }
  return std::move(b.mesh());
}

Mesh MakeFallenTrunk(const LandscapeMaterials& materials, Random random) {
  MeshBuilder b(materials);
  const float length = Draw(random, 3, 7);
  const float radius = Draw(random, 0.12, 0.28);
  const float grey = Draw(random, 0.5, 0.9);
  b.set_tint({grey, grey, 0.95F * grey, 1});
  const Vector3f begin(-0.5F * length, 0, 0.8F * radius);
  const Vector3f end(0.5F * length, Draw(random, -0.4, 0.4), 0.8F * radius + Draw(random, 0, 0.3));
  b.AddTube(materials.bark, begin, end, radius, 0.7F * radius, 12);
  for (int i = 0; i < 6; ++i) {
    const Vector3f root = begin + Draw(random, 0.2, 0.95) * (end - begin);
    const Vector3f side(Draw(random, 0.2, 0.8), Draw(random, -1, 1), Draw(random, 0, 1));
    b.AddTube(materials.bark, root, root + Draw(random, 0.25, 0.9) * side.normalized(),
              0.14F * radius, 0.06F * radius, 5);
  }
  // The sawn or broken ends.
  for (const bool is_end : {false, true}) {
    const Vector3f& middle = is_end ? end : begin;
    const float r = is_end ? 0.7F * radius : radius;
    b.set_tint({0.75F, 0.6F, 0.42F, 1});
    const float s = is_end ? 1.0F : -1.0F;
    b.AddFace(materials.trim, middle + Vector3f(0, -0.7F * s * r, -0.7F * r),
              middle + Vector3f(0, 0.7F * s * r, -0.7F * r),
              middle + Vector3f(0, 0.7F * s * r, 0.7F * r),
              middle + Vector3f(0, -0.7F * s * r, 0.7F * r));
  }
  return std::move(b.mesh());
}

}  // namespace orb360::town
