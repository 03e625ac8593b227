#include "apps/town/render/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/town/image/noise.h"
#include "apps/town/image/random.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr int kSize = 1024;            // texels along a side of the map: 0.1 to 0.2 degrees each
constexpr float kSunRadius = 0.0047F;  // radians
constexpr float kPi = std::numbers::pi_v<float>;

/// Direction of a point of the map, (x, y) in [-1, 1]²: the octahedron of the hemisphere seen from
/// above, turned by 45 degrees to fill the square.
Vector3f DirectionOf(float x, float y) {
  const float px = 0.5F * (x + y);
  const float py = 0.5F * (x - y);
  return Vector3f(px, py, 1 - std::abs(px) - std::abs(py)).normalized();
}

}  // namespace

Light MakeLight(std::string_view name, uint64_t seed) {
  Random random(seed ^ 0x11657);
  const auto azimuth = static_cast<float>(random.Uniform(0, 2 * std::numbers::pi));
  Light light;
  light.name = name;
  float elevation = 0;
  if (name == "noon") {
    elevation = static_cast<float>(random.Uniform(0.9, 1.1));
    light.sun = {2.05F, 1.93F, 1.74F};
    light.zenith = {0.22F, 0.38F, 0.72F};
    light.horizon = {0.68F, 0.80F, 0.95F};
    light.ground = {0.24F, 0.23F, 0.21F};
    light.cloud_cover = 0.42F;
  } else if (name == "morning") {
    elevation = static_cast<float>(random.Uniform(0.38, 0.5));
    light.sun = {2.45F, 2.0F, 1.48F};
    light.zenith = {0.26F, 0.42F, 0.74F};
    light.horizon = {0.95F, 0.94F, 0.92F};
    light.ground = {0.24F, 0.22F, 0.20F};
    light.cloud_cover = 0.35F;
    light.haze = 500;
  } else if (name == "sunset") {
    elevation = static_cast<float>(random.Uniform(0.16, 0.24));
    light.sun = {3.2F, 1.85F, 0.95F};
    light.zenith = {0.34F, 0.46F, 0.76F};
    light.horizon = {1.35F, 0.92F, 0.64F};
    light.ground = {0.30F, 0.25F, 0.22F};
    light.cloud_cover = 0.5F;
    light.haze = 600;
  } else if (name == "overcast") {
    elevation = 0.8F;
    light.zenith = {1.3F, 1.35F, 1.4F};
    light.horizon = {1.05F, 1.1F, 1.16F};
    light.ground = {0.33F, 0.33F, 0.31F};
    light.cloud_cover = 1;
    light.haze = 450;
  } else {
    throw UserError("unknown light '" + std::string(name) +
                    "': use noon, morning, sunset or overcast");
  }
  light.to_sun = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                  std::sin(elevation)};
  return light;
}

Sky::Sky(const Light& light, uint64_t seed) : texels_(static_cast<size_t>(kSize) * kSize) {
  const auto noise_seed = static_cast<uint32_t>(Hash(seed ^ 0x5c1));
#pragma omp parallel for schedule(dynamic, 8)
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Vector3f direction = DirectionOf((static_cast<float>(x) + 0.5F) * 2 / kSize - 1,
                                             (static_cast<float>(y) + 0.5F) * 2 / kSize - 1);
      texels_[static_cast<size_t>(y) * kSize + static_cast<size_t>(x)] =
          Compute(direction, light, noise_seed).homogeneous();
    }
  }
  constexpr int kRings = 16;
  constexpr int kSectors = 32;
  for (int ring = 0; ring < kRings; ++ring) {  // equal steps of sin²: equal fractions of irradiance
    const float sine = std::sqrt((static_cast<float>(ring) + 0.5F) / kRings);
    const float cosine = std::sqrt(1 - sine * sine);
    for (int sector = 0; sector < kSectors; ++sector) {
      const float angle = 2 * kPi * static_cast<float>(sector) / kSectors;
      const Vector3f direction(sine * std::cos(angle), sine * std::sin(angle), cosine);
      mean_ +=
          Radiance(direction).cwiseMin(1.5F) / (kRings * kSectors);  // the sun is lit separately
    }
  }
}

Vector3f Sky::Compute(const Vector3f& direction, const Light& light, uint32_t seed) const {
  const float height = std::max(direction.z(), 0.0F);
  const float to_horizon = std::pow(1 - height, 4.0F);
  const float cos_sun = std::clamp(direction.dot(light.to_sun), -1.0F, 1.0F);
  const bool has_sun = light.sun.maxCoeff() > 0;
  Vector3f colour = light.zenith + to_horizon * (light.horizon - light.zenith);
  const Vector3f sun_colour = light.sun / std::max(light.sun.maxCoeff(), 1e-3F);
  const float angle = std::acos(cos_sun);
  if (has_sun) {
    colour += sun_colour * (0.45F * std::exp(-angle * 3.0F) + 0.9F * std::exp(-angle * 14.0F) +
                            4.0F * std::exp(-angle * 70.0F));
  }
  // Clouds lie on a curved layer: noise at the point where the ray meets it.
  const float distance = 1 / (height + 0.12F);
  const float x = 0.075F * direction.x() * distance + 0.5F;
  const float y = 0.075F * direction.y() * distance + 0.5F;
  const float threshold = 0.75F - 1.5F * light.cloud_cover;
  const auto thickness_at = [&](float px, float py, int octaves) {
    return TiledFbm(px, py, 7, octaves, seed, 0.6F) + 0.55F * TiledFbm(px, py, 3, 2, seed + 9) -
           threshold;
  };
  const float thickness = thickness_at(x, y, 8);
  const float density = SmoothStep(0.0F, 0.45F, thickness);
  // Clouds are bright where the layer becomes thinner towards the sun, and grey where it is thick.
  const float ahead = thickness_at(x + 0.02F * light.to_sun.x(), y + 0.02F * light.to_sun.y(), 5);
  const float lit = std::clamp(1.02F - 0.32F * SmoothStep(0.1F, 1.3F, thickness) +
                                   0.45F * std::clamp(thickness - ahead, -0.8F, 0.8F),
                               0.4F, 1.25F);
  const Vector3f white = has_sun ? Vector3f(0.55F * light.horizon + 0.66F * light.sun / 1.9F)
                                 : Vector3f(1.25F * light.horizon);
  const float thin = density * (1 - 0.55F * to_horizon);
  colour += thin * (lit * white - colour);
  if (has_sun)
    colour += 40 * sun_colour * (1 - SmoothStep(kSunRadius, 2 * kSunRadius, angle)) * (1 - thin);
  return colour;
}

Vector3f Sky::Radiance(const Vector3f& direction) const {
  const float z = std::max(direction.z(), 0.0F);
  const float scale = 1 / (std::abs(direction.x()) + std::abs(direction.y()) + z + 1e-9F);
  const float px = direction.x() * scale;
  const float py = direction.y() * scale;
  const float x = std::clamp((px + py + 1) * (0.5F * kSize) - 0.5F, 0.0F, kSize - 1.001F);
  const float y = std::clamp((px - py + 1) * (0.5F * kSize) - 0.5F, 0.0F, kSize - 1.001F);
  const auto x0 = static_cast<size_t>(x);
  const auto y0 = static_cast<size_t>(y);
  const float wx = x - static_cast<float>(x0);
  const float wy = y - static_cast<float>(y0);
  const Eigen::Vector4f* row0 = texels_.data() + y0 * kSize + x0;
  const Eigen::Vector4f* row1 = row0 + kSize;
  const Eigen::Vector4f mean =
      (1 - wy) * ((1 - wx) * row0[0] + wx * row0[1]) + wy * ((1 - wx) * row1[0] + wx * row1[1]);
  return mean.head<3>();
}

}  // namespace orb360::town
