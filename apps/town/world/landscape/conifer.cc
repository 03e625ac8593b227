#include "apps/town/world/landscape/conifer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "apps/town/world/plant_card.h"

namespace orb360::town {
namespace {

/// The trunk's middle line and radius by height.
struct Trunk {
  float height;
  float radius;
  Vector2f lean;

  Vector3f At(float z) const {
    const float t = z / height;
    return {t * t * lean.x(), t * t * lean.y(), z};
  }
  float RadiusAt(float z) const {
    const float t = z / height;
    const float foot = 0.5F * std::exp(-std::max(0.0F, z) / 0.25F);
    return radius * (1 + foot) * (1 - 0.93F * t);
  }
};

}  // namespace

Mesh MakeConifer(const LandscapeMaterials& materials, const ConiferShape& shape, Random random) {
  MeshBuilder b(materials);
  const auto draw = [&](double low, double high) {
    return static_cast<float>(random.Uniform(low, high));
  };
  const Trunk trunk{shape.height, shape.radius, {draw(-0.3, 0.3), draw(-0.3, 0.3)}};
  const float brown = draw(0.55, 1);
  b.set_tint({brown, 0.92F * brown, 0.85F * brown, 1});
  const std::array<float, 9> knots = {-0.4F,
                                      0.05F,
                                      0.3F,
                                      0.8F,
                                      0.2F * shape.height,
                                      0.4F * shape.height,
                                      0.6F * shape.height,
                                      0.8F * shape.height,
                                      shape.height};
  for (size_t i = 1; i < knots.size(); ++i)
    b.AddTube(materials.bark, trunk.At(knots[i - 1]), trunk.At(knots[i]),
              trunk.RadiusAt(knots[i - 1]), trunk.RadiusAt(knots[i]), i < 6 ? 10 : 6);
  const MaterialId needles = random.Pick(std::span<const MaterialId>(materials.needles));
  const float green = draw(0.7, 1.1);
  constexpr float kPi = std::numbers::pi_v<float>;
  for (float z = 0.5F; z < shape.height - 0.1F; z += draw(0.24, 0.42)) {
    const bool is_dead = z < shape.crown_base;
    // Branches grow longer from the top down to the crown's base.
    const float t =
        std::clamp((z - shape.crown_base) / (shape.height - shape.crown_base), 0.0F, 1.0F);
    const int count = 4 + random.Int(3);
    const float turn = draw(0, 2 * kPi);
    for (int i = 0; i < count; ++i) {
      if (is_dead && random.Chance(0.6)) continue;
      const float angle =
          turn + 2 * kPi * (static_cast<float>(i) + draw(-0.25, 0.25)) / static_cast<float>(count);
      const float rise = is_dead ? draw(-0.5, 0.2) : 0.6F * t - 0.15F + draw(-0.15, 0.15);
      const Vector3f out(std::cos(angle), std::sin(angle), 0);
      const Vector3f along = (out + rise * Vector3f::UnitZ()).normalized();
      const Vector3f root = trunk.At(z) + 0.5F * trunk.RadiusAt(z) * out;
      if (is_dead) {
        b.set_tint({0.5F * brown, 0.48F * brown, 0.46F * brown, 1});
        b.AddTube(materials.bark, root, root + draw(0.15, 0.35) * shape.spread * along, 0.012F,
                  0.004F, 4);
        continue;
      }
      const float length = shape.spread * (0.12F + 0.88F * std::pow(1 - t, 0.8F)) * draw(0.75, 1.1);
      const float shade = green * draw(0.65, 1.05);
      b.set_tint({0.95F * shade, shade, 0.9F * shade, 1});
      const Vector3f level = Vector3f(-out.y(), out.x(), 0);
      PlantCard card{.root = root, .along = along, .length = length, .droop = 0.22F * length};
      // One card lies, and one stands on its edge, so that a branch is seen from all sides.
      for (const float roll : {draw(-0.4, 0.4), kPi / 2 + draw(-0.4, 0.4)}) {
        card.across = std::cos(roll) * level + std::sin(roll) * level.cross(along);
        card.width = length * (std::abs(std::cos(roll)) > 0.5F ? draw(0.6, 0.85) : draw(0.3, 0.5));
        card.light = (0.6F * out + Vector3f(0, 0, 0.8F)).normalized();
        AddPlantCard(card, needles, b);
      }
    }
  }
  return std::move(b.mesh());
}

}  // namespace orb360::town
