#include "apps/town/world/pedestrian.h"

#include <cmath>
#include <numbers>

namespace orb360::town {

Mesh MakePedestrian(uint32_t phase, const Materials& materials, Random random) {
  MeshBuilder b(materials);
  const MaterialId cloth = materials.trim;
  const auto scale = static_cast<float>(random.Uniform(0.92, 1.08));
  const auto colour = [&random](double low, double high) {
    const auto grey = static_cast<float>(random.Uniform(low, high));
    return Rgba{grey * static_cast<float>(random.Uniform(0.5, 1.2)),
                grey * static_cast<float>(random.Uniform(0.5, 1.1)),
                grey * static_cast<float>(random.Uniform(0.5, 1.2)), 1};
  };
  const Rgba coat = colour(0.05, 0.5);
  const Rgba trousers = colour(0.03, 0.2);
  const Rgba skin =
      Mix({0.62F, 0.38F, 0.27F, 1}, {0.2F, 0.11F, 0.07F, 1}, static_cast<float>(random.Uniform()));
  const Rgba hair = colour(0.01, 0.15);
  const float swing =
      std::sin(2 * std::numbers::pi_v<float> * static_cast<float>(phase) / kWalkPhases);
  const auto limb = [&](const Rgba& tint, const Vector3f& joint, float angle, float bend,
                        float upper, float lower, float radius) {
    b.set_tint(tint);
    const Vector3f knee = joint + upper * Vector3f(std::sin(angle), 0, -std::cos(angle));
    Vector3f end = knee + lower * Vector3f(std::sin(angle - bend), 0, -std::cos(angle - bend));
    b.AddTube(cloth, knee, joint, 0.8F * radius, radius, 8);
    b.AddTube(cloth, end, knee, 0.65F * radius, 0.8F * radius, 8);
    return end;
  };
  for (const float side : {1.0F, -1.0F}) {
    const float angle = 0.45F * side * swing;
    const float bend = 0.15F + 0.35F * std::max(0.0F, -side * swing);
    const Vector3f foot = limb(trousers, scale * Vector3f(0, 0.09F * side, 0.9F), angle, bend,
                               0.44F * scale, 0.42F * scale, 0.085F * scale);
    b.set_tint({0.03F, 0.025F, 0.02F, 1});
    b.AddEllipsoid(cloth, foot + scale * Vector3f(0.06F, 0, -0.01F),
                   scale * Vector3f(0.13F, 0.045F, 0.045F));
    const Vector3f hand = limb(coat, scale * Vector3f(0, 0.21F * side, 1.4F), -0.8F * angle, -0.3F,
                               0.3F * scale, 0.26F * scale, 0.055F * scale);
    b.set_tint(skin);
    b.AddEllipsoid(cloth, hand, scale * Vector3f(0.045F, 0.03F, 0.055F));
  }
  b.set_tint(coat);
  b.AddEllipsoid(cloth, scale * Vector3f(0, 0, 1.18F), scale * Vector3f(0.13F, 0.2F, 0.34F));
  b.set_tint(trousers);
  b.AddEllipsoid(cloth, scale * Vector3f(0, 0, 0.9F), scale * Vector3f(0.12F, 0.17F, 0.14F));
  b.set_tint(skin);
  b.AddTube(cloth, scale * Vector3f(0, 0, 1.42F), scale * Vector3f(0.01F, 0, 1.55F), 0.05F * scale,
            0.05F * scale, 8);
  b.AddEllipsoid(cloth, scale * Vector3f(0.02F, 0, 1.62F), scale * Vector3f(0.095F, 0.075F, 0.12F));
  b.set_tint(hair);
  b.AddEllipsoid(cloth, scale * Vector3f(-0.015F, 0, 1.65F),
                 scale * Vector3f(0.095F, 0.085F, 0.11F));
  return std::move(b.mesh());
}

}  // namespace orb360::town
