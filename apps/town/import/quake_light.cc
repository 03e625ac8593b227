#include "apps/town/import/quake_light.h"

#include <algorithm>
#include <cmath>

#include "apps/town/import/quake_bsp.h"

namespace orb360::town {

Eigen::Vector3f SampleLightPage(std::span<const uint8_t> page, const Eigen::Vector2f& uv) {
  constexpr auto kSide = static_cast<float>(kLightPageSide);
  const auto texel = [&](size_t x, size_t y) {
    const uint8_t* p = &page[3 * (y * kLightPageSide + x)];
    return Eigen::Vector3f(p[0], p[1], p[2]);
  };
  const float x = std::clamp(uv.x() * kSide - 0.5F, 0.0F, kSide - 1);
  const float y = std::clamp(uv.y() * kSide - 0.5F, 0.0F, kSide - 1);
  const size_t x0 = std::min(static_cast<size_t>(x), kLightPageSide - 2);
  const size_t y0 = std::min(static_cast<size_t>(y), kLightPageSide - 2);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  return (1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0)) +
         fy * ((1 - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1));
}

Eigen::Vector3f QuakeIrradiance(const Eigen::Vector3f& light) {
  constexpr float kOverbright = 4;
  constexpr float kBrightest = 2;
  constexpr float kGamma = 2.2F;
  Eigen::Vector3f shown = kOverbright / 255 * light;
  const float largest = shown.maxCoeff();
  if (largest > kBrightest) shown *= kBrightest / largest;
  return shown.array().pow(kGamma);
}

}  // namespace orb360::town
