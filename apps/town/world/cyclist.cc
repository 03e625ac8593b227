#include "apps/town/world/cyclist.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace orb360::town {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;
constexpr float kWheelRadius = 0.335F;  // metres, as all that follows
constexpr float kTyre = 0.02F;
const Vector3f kFrontHub(0.52F, 0, kWheelRadius);
const Vector3f kRearHub(-0.52F, 0, kWheelRadius);
const Vector3f kCrank(-0.08F, 0, 0.29F);
const Vector3f kSaddle(-0.27F, 0, 0.96F);
const Vector3f kSteering(0.33F, 0, 0.86F);  // top of the fork
constexpr float kCrankLength = 0.17F;

void AddWheel(MeshBuilder& b, const Vector3f& hub) {
  constexpr int kPieces = 20;
  constexpr int kSpokes = 7;
  const auto rim = [&hub](int i, int of, float radius) {
    const float angle = kTurn * static_cast<float>(i) / static_cast<float>(of);
    return Vector3f(hub + radius * Vector3f(std::cos(angle), 0, std::sin(angle)));
  };
  const MaterialId rubber = b.materials().rubber;
  const MaterialId metal = b.materials().metal;
  b.set_tint({0.02F, 0.02F, 0.02F, 1});
  for (int i = 0; i < kPieces; ++i) {
    b.AddTube(rubber, rim(i, kPieces, kWheelRadius - kTyre),
              rim(i + 1, kPieces, kWheelRadius - kTyre), kTyre, kTyre, 5);
  }
  b.set_tint({0.4F, 0.41F, 0.43F, 1});
  for (int i = 0; i < kSpokes; ++i)
    b.AddTube(metal, hub, rim(i, kSpokes, kWheelRadius - kTyre), 0.004F, 0.003F, 3);
}

/// Adds wheels, frame, fork, handlebar and saddle.
void AddBicycle(MeshBuilder& b) {
  const Materials& m = b.materials();
  AddWheel(b, kFrontHub);
  AddWheel(b, kRearHub);
  b.set_tint({1, 1, 1, 1});
  const Vector3f seat_post = kCrank + 0.8F * (kSaddle - kCrank);
  const auto tube = [&](const Vector3f& from, const Vector3f& to, float radius) {
    b.AddTube(m.paint, from, to, radius, radius, 7);
  };
  tube(kCrank, seat_post, 0.018F);
  tube(kCrank, kSteering - Vector3f(0, 0, 0.1F), 0.02F);
  tube(seat_post, kSteering, 0.018F);
  for (const float side : {0.05F, -0.05F}) {
    const Vector3f aside(0, side, 0);
    tube(kCrank + aside, kRearHub + aside, 0.011F);
    tube(seat_post, kRearHub + aside, 0.01F);
    tube(kSteering, kFrontHub + aside, 0.013F);
  }
  b.set_tint({0.04F, 0.04F, 0.045F, 1});
  const Vector3f stem = kSteering + Vector3f(-0.02F, 0, 0.2F);
  b.AddTube(m.metal, kSteering, stem, 0.015F, 0.015F, 6);
  const auto half_bar = static_cast<float>(0.5 * kHandlebarWidth);
  b.AddTube(m.metal, stem + Vector3f(0, -half_bar, 0), stem + Vector3f(0, half_bar, 0), 0.014F,
            0.014F, 6);
  b.AddTube(m.metal, seat_post, kSaddle, 0.013F, 0.013F, 6);
  b.AddEllipsoid(m.rubber, kSaddle, {0.13F, 0.07F, 0.035F});
}

/// Returns the joint of two limbs of the given lengths from `from` to `to`, bent towards `outward`.
Vector3f Joint(const Vector3f& from, const Vector3f& to, float first, float second,
               const Vector3f& outward) {
  const Vector3f along = to - from;
  const float reach = std::min(along.norm(), 0.999F * (first + second));
  const float distance = (first * first - second * second + reach * reach) / (2 * reach);
  const Vector3f direction = along.normalized();
  const Vector3f across = (outward - outward.dot(direction) * direction).normalized();
  return from + distance * direction + std::sqrt(first * first - distance * distance) * across;
}

}  // namespace

Mesh MakeCyclist(uint32_t phase, const Materials& materials, Random random) {
  MeshBuilder b(materials);
  AddBicycle(b);
  const MaterialId cloth = materials.trim;
  const auto colour = [&random](double low, double high) {
    const auto channel = [&] { return static_cast<float>(random.Uniform(low, high)); };
    const float red = channel();
    const float green = channel();
    return Rgba{red, green, channel(), 1};
  };
  const Rgba coat = colour(0.05, 0.55);
  const Rgba trousers = colour(0.02, 0.15);
  const Rgba helmet = colour(0.05, 0.6);
  const Rgba skin =
      Mix({0.62F, 0.38F, 0.27F, 1}, {0.2F, 0.11F, 0.07F, 1}, static_cast<float>(random.Uniform()));
  const auto limb = [&](const Rgba& tint, const Vector3f& from, const Vector3f& joint,
                        const Vector3f& to, float radius) {
    b.set_tint(tint);
    b.AddTube(cloth, joint, from, 0.8F * radius, radius, 8);
    b.AddTube(cloth, to, joint, 0.62F * radius, 0.8F * radius, 8);
    b.AddEllipsoid(cloth, joint, Vector3f::Constant(0.82F * radius));
  };
  const Vector3f hips = kSaddle + Vector3f(0.02F, 0, 0.08F);
  const Vector3f shoulders(0.12F, 0, 1.5F);
  for (const float side : {1.0F, -1.0F}) {
    const float angle =
        kTurn * (static_cast<float>(phase) / kPedalPhases + (side > 0 ? 0.0F : 0.5F));
    const Vector3f pedal = kCrank + Vector3f(kCrankLength * std::cos(angle), 0.1F * side,
                                             -kCrankLength * std::sin(angle));
    b.set_tint({0.3F, 0.3F, 0.32F, 1});
    b.AddTube(materials.metal, kCrank + Vector3f(0, 0.07F * side, 0),
              pedal - Vector3f(0, 0.03F * side, 0), 0.014F, 0.012F, 5);
    const Vector3f hip = hips + Vector3f(0, 0.09F * side, 0);
    const Vector3f ankle = pedal + Vector3f(-0.07F, 0, 0.1F);
    limb(trousers, hip, Joint(hip, ankle, 0.44F, 0.43F, Vector3f::UnitX()), ankle, 0.085F);
    b.set_tint({0.03F, 0.025F, 0.02F, 1});
    b.AddEllipsoid(cloth, pedal + Vector3f(0.01F, 0, 0.05F), {0.13F, 0.045F, 0.045F});
    const Vector3f shoulder = shoulders + Vector3f(0, 0.19F * side, 0);
    const Vector3f hand =
        kSteering + Vector3f(-0.03F, static_cast<float>(0.46 * kHandlebarWidth) * side, 0.22F);
    limb(coat, shoulder, Joint(shoulder, hand, 0.3F, 0.28F, {-0.4F, 0.6F * side, -0.5F}), hand,
         0.055F);
    b.set_tint(skin);
    b.AddEllipsoid(cloth, hand, {0.05F, 0.04F, 0.035F});
  }
  b.set_tint(coat);
  b.AddTube(cloth, hips, shoulders, 0.15F, 0.17F, 12);
  b.AddEllipsoid(cloth, shoulders, {0.15F, 0.22F, 0.12F});
  b.set_tint(trousers);
  b.AddEllipsoid(cloth, hips, {0.16F, 0.17F, 0.13F});
  b.set_tint(skin);
  const Vector3f head = shoulders + Vector3f(0.1F, 0, 0.25F);
  b.AddTube(cloth, shoulders, head, 0.055F, 0.05F, 8);
  b.AddEllipsoid(cloth, head, {0.095F, 0.075F, 0.12F});
  b.set_tint(helmet);
  b.AddEllipsoid(cloth, head + Vector3f(-0.015F, 0, 0.055F), {0.13F, 0.095F, 0.085F});
  return std::move(b.mesh());
}

}  // namespace orb360::town
