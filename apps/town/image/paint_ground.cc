#include <algorithm>
#include <cmath>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"

namespace orb360::town {
namespace {

/// Returns 1 on the lines where two cells of a distorted cellular noise meet, falling to 0 at
/// `width` cells from them: cracks.
float Cracks(float x, float y, int frequency, float width, uint32_t seed) {
  const float bend = 0.35F / static_cast<float>(frequency);
  const float wx = x + bend * TiledFbm(x, y, frequency * 2, 4, seed + 1);
  const float wy = y + bend * TiledFbm(x, y, frequency * 2, 4, seed + 2);
  const Cell cell = TiledCells(wx - std::floor(wx), wy - std::floor(wy), frequency, seed);
  return 1 - SmoothStep(0, width, cell.second - cell.nearest);
}

}  // namespace

Texture PaintAsphalt(uint32_t seed) {
  constexpr int kSize = 1024;
  return Texture::Paint(kSize, [seed](float x, float y) {
    // Stones of the aggregate; a texel (8 mm) is about one stone.
    const float stone =
        LatticeValue(static_cast<int>(x * kSize), static_cast<int>(y * kSize), seed);
    float value = 0.062F + 0.034F * stone * stone;
    value *= 1 + 0.2F * TiledFbm(x, y, 3, 7, seed + 10, 0.65F);
    const float wear = SmoothStep(-0.1F, 0.5F, TiledFbm(x, y, 2, 3, seed + 30));
    value *= 1 - 0.7F * wear * Cracks(x, y, 6, 0.018F, seed + 40);
    value *= 1 - 0.35F * Cracks(x, y, 24, 0.03F, seed + 50) *
                     SmoothStep(0.3F, 0.8F, TiledFbm(x, y, 2, 3, seed + 60));
    // Oil drips and chewing gum.
    const Cell spot = TiledCells(x, y, 22, seed + 70);
    const float spot_radius = 0.04F + 0.12F * static_cast<float>(spot.id >> 8 & 255U) / 255;
    if (spot.id % 4 == 0)
      value *= 1 - 0.3F * (1 - SmoothStep(0.3F * spot_radius, spot_radius, spot.nearest));
    const float tone = 0.03F * TiledFbm(x, y, 2, 4, seed + 80);
    return Rgba{value * (1.02F + tone), value, value * (0.97F - tone), 1};
  });
}

Texture PaintFreshAsphalt(uint32_t seed) {
  constexpr int kSize = 512;
  return Texture::Paint(kSize, [seed](float x, float y) {
    const float stone =
        LatticeValue(static_cast<int>(x * kSize), static_cast<int>(y * kSize), seed);
    const float value =
        (0.05F + 0.035F * stone * stone) * (1 + 0.15F * TiledFbm(x, y, 4, 6, seed + 1, 0.6F));
    return Rgba{value, value, value * 1.02F, 1};
  });
}

Texture PaintManhole(uint32_t seed) {
  return Texture::Paint(128, [seed](float x, float y) {
    const float radius = 2 * std::hypot(x - 0.5F, y - 0.5F);
    // A chequer pattern of raised studs inside a plain rim.
    const float stud = std::max(std::abs(std::sin(x * 50)), std::abs(std::sin(y * 50)));
    float value = radius > 0.86F ? 0.2F : 0.09F + 0.09F * SmoothStep(0.6F, 0.9F, stud);
    if (std::abs(radius - 0.84F) < 0.025F) value = 0.015F;
    if (std::abs(radius - 0.5F) < 0.06F) value = 0.13F;
    value *= 1 + 0.25F * TiledFbm(x, y, 6, 5, seed, 0.7F);
    const float rust = SmoothStep(0, 1, TiledFbm(x, y, 3, 4, seed + 1));
    return Rgba{value * (1.05F + 0.25F * rust), value, value * (0.92F - 0.2F * rust), 1};
  });
}

Texture PaintDrain(uint32_t seed) {
  return Texture::Paint(128, [seed](float x, float y) {
    const float bar = std::abs(x * 9 - std::floor(x * 9) - 0.5F);
    const bool frame = std::min({x, y, 1 - x, 1 - y}) < 0.09F || std::abs(y - 0.5F) < 0.04F;
    const float value =
        (frame || bar > 0.28F ? 0.12F : 0.008F) * (1 + 0.3F * TiledFbm(x, y, 6, 5, seed, 0.7F));
    return Rgba{value * 1.1F, value, value * 0.9F, 1};
  });
}

Texture PaintPavingSlabs(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kRows = 8;
    const int row = static_cast<int>(y * kRows);
    const float shifted = x * kRows + (row % 2 == 0 ? 0.0F : 0.5F);
    const int column = static_cast<int>(shifted) % kRows;
    const float u = shifted - std::floor(shifted);
    const float v = y * kRows - static_cast<float>(row);
    const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
    const float shade = LatticeValue(column, row, seed);
    float value = 0.23F * (0.82F + 0.28F * shade);
    value *= 1 + 0.10F * TiledFbm(x, y, 128, 3, seed + 1, 0.8F) +
             0.14F * TiledFbm(x, y, 5, 6, seed + 2, 0.6F);
    if (LatticeValue(column, row, seed + 3) > 0.9F) {
      value *= 1 - 0.6F * Cracks(x, y, 12, 0.05F, seed + 4);
    }
    value *=
        0.35F + 0.65F * SmoothStep(0.005F, 0.03F, edge + 0.008F * TiledFbm(x, y, 64, 2, seed + 5));
    const Cell gum = TiledCells(x, y, 30, seed + 6);
    if (gum.id % 9 == 0) value *= 1 - 0.4F * (1 - SmoothStep(0.1F, 0.2F, gum.nearest));
    const float tone = 0.05F * (LatticeValue(column, row, seed + 7) - 0.5F);
    return Rgba{value * (1.04F + tone), value, value * (0.93F - tone), 1};
  });
}

Texture PaintSetts(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kRows = 32;
    const int row = static_cast<int>(y * kRows);
    const float v = y * kRows - static_cast<float>(row);
    const float shifted = x * kRows + LatticeValue(row, 0, seed) +
                          0.12F * GradientNoise(x * kRows, y * kRows, kRows, seed + 1);
    const float wrapped = shifted - kRows * std::floor(shifted / kRows);
    const int column = static_cast<int>(wrapped) % kRows;
    const float u = wrapped - std::floor(wrapped);
    const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
    const float dome = SmoothStep(0.02F, 0.25F, edge);
    float value = 0.13F + 0.16F * LatticeValue(column, row, seed + 2);
    value *= (0.3F + 0.7F * dome) * (1 + 0.15F * TiledFbm(x, y, 100, 4, seed + 3, 0.8F) +
                                     0.12F * TiledFbm(x, y, 4, 4, seed + 4));
    const float tone = 0.15F * (LatticeValue(column, row, seed + 5) - 0.4F);
    return Rgba{value * (1 + tone), value, value * (1 - tone), 1};
  });
}

Texture PaintConcrete(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    float value = 0.33F * (1 + 0.16F * TiledFbm(x, y, 3, 8, seed, 0.7F) +
                           0.06F * TiledFbm(x, y, 128, 2, seed + 1));
    value *= 1 - 0.3F * Cracks(x, y, 5, 0.02F, seed + 2) *
                     SmoothStep(0, 0.5F, TiledFbm(x, y, 2, 3, seed + 3));
    const Cell hole = TiledCells(x, y, 60, seed + 4);
    if (hole.id % 4 == 0) value *= 1 - 0.4F * (1 - SmoothStep(0.08F, 0.2F, hole.nearest));
    return Rgba{value * 1.02F, value, value * 0.95F, 1};
  });
}

Texture PaintGrass(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    // Blades lie in all directions, so noise is stretched along x and along y.
    const float blades = std::max(TiledFbm(x, 0.25F * y, 128, 2, seed, 0.9F),
                                  TiledFbm(0.25F * x, y, 128, 2, seed + 9, 0.9F));
    const float clumps = TiledFbm(x, y, 12, 5, seed + 1, 0.65F);
    const float dry = SmoothStep(0.0F, 1.0F, TiledFbm(x, y, 3, 6, seed + 2, 0.6F));
    const Rgba green = Mix(Srgb(44, 60, 30), Srgb(80, 90, 50), 0.5F + 0.5F * clumps);
    Rgba colour = Mix(green, Srgb(128, 120, 82), 0.7F * dry);
    const float bare = SmoothStep(0.75F, 1.0F, TiledFbm(x, y, 4, 6, seed + 3, 0.6F));
    colour = Mix(colour, Srgb(96, 82, 64), 0.8F * bare);
    // Daisies, clover and fallen leaves.
    const Cell speck = TiledCells(x, y, 48, seed + 4);
    if (speck.id % 11 == 0 && speck.nearest < 0.16F)
      return speck.id % 2 == 0 ? Srgb(196, 192, 170) : Srgb(120, 88, 44);
    return std::max(0.2F, 0.85F + 0.45F * blades + 0.2F * clumps) * colour;
  });
}

Texture PaintRoadPaint(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    const float wear = TiledFbm(x, y, 6, 7, seed, 0.75F);
    const float grime = SmoothStep(-0.6F, 1.0F, TiledFbm(x, y, 3, 6, seed + 3, 0.65F));
    const float value = (0.5F - 0.2F * grime) * (1 + 0.1F * TiledFbm(x, y, 60, 3, seed + 1, 0.8F)) -
                        0.14F * SmoothStep(0, 1, wear);
    const float cracked = Cracks(x, y, 10, 0.03F, seed + 2);
    return Rgba{value, value * 0.99F, value * 0.94F, wear + 0.8F * cracked > 0.7F ? 0.0F : 1.0F};
  });
}

}  // namespace orb360::town
