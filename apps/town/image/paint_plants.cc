#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

struct Leaf {
  float x;
  float y;
  float angle;
  float length;
  float shade;
};

}  // namespace

Texture PaintLeaves(uint32_t seed) {
  constexpr float kPi = std::numbers::pi_v<float>;
  Random random(seed);
  std::vector<Leaf> leaves;
  for (int i = 0; i < 70; ++i) {
    // Leaves grow along five twigs that fan out from the bottom centre.
    const int twig = i % 5;
    const float direction = kPi / 2 + 0.55F * static_cast<float>(twig - 2);
    const auto along = static_cast<float>(random.Uniform(0.12, 0.78));
    const float side = random.Chance(0.5) ? 1.0F : -1.0F;
    leaves.push_back({0.5F + along * 0.62F * std::cos(direction),
                      0.06F + along * 1.02F * std::sin(direction),
                      direction + side * static_cast<float>(random.Uniform(0.3, 1.3)),
                      static_cast<float>(random.Uniform(0.11, 0.19)),
                      static_cast<float>(random.Uniform(0.55, 1.25))});
  }
  const Rgba base = Mix({0.14F, 0.19F, 0.045F, 1}, {0.095F, 0.15F, 0.06F, 1},
                        static_cast<float>(random.Uniform()));
  return Texture::Paint(256, [=](float x, float y) {
    Rgba colour{0.06F, 0.09F, 0.03F, 0};
    for (const Leaf& leaf : leaves) {
      const float c = std::cos(leaf.angle);
      const float s = std::sin(leaf.angle);
      const float along = ((x - leaf.x) * c + (y - leaf.y) * s) / leaf.length;
      const float across = (-(x - leaf.x) * s + (y - leaf.y) * c) / leaf.length;
      if (along < 0 || along > 1) continue;
      const float half_width = 0.32F * std::sin(kPi * std::pow(along, 0.8F));
      if (std::abs(across) > half_width) continue;
      const float vein = std::abs(across) < 0.02F ? 1.3F : 1.0F;
      const float shade = leaf.shade * vein * (0.85F + 0.3F * along) * (across > 0 ? 1.0F : 0.82F);
      colour = shade * base;
    }
    return colour;
  });
}

Texture PaintBark(uint32_t seed) {
  return Texture::Paint(256, [seed](float x, float y) {
    const float ridge = TiledFbm(x, 0.25F * y, 16, 5, seed, 0.7F);
    const float value = 0.16F * (1 + 0.5F * ridge) * (1 + 0.2F * TiledFbm(x, y, 4, 5, seed + 1));
    return Rgba{value * 1.1F, value, value * 0.82F, 1};
  });
}

}  // namespace orb360::town
