#include <algorithm>
#include <cmath>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"

namespace orb360::town {

Texture PaintBrick(uint32_t seed, const Rgba& brick, const Rgba& mortar) {
  return Texture::Paint(512, [=](float x, float y) {
    constexpr int kColumns = 16;
    constexpr int kRows = 52;
    const int row = static_cast<int>(y * kRows);
    const float shifted = x * kColumns + (row % 2 == 0 ? 0.0F : 0.5F);
    const int column = static_cast<int>(shifted) % kColumns;
    const float u = (shifted - std::floor(shifted)) * 0.25F;               // metres in the brick
    const float v = (y * kRows - static_cast<float>(row)) * 4.0F / kRows;  // metres in the course
    const float rough = 0.004F * TiledFbm(x, y, 100, 3, seed);
    const float edge = std::min(std::min(u, 0.25F - u), std::min(v, 4.0F / kRows - v)) + rough;
    const float shade = 0.62F + 0.6F * LatticeValue(column, row, seed + 1);
    const float burnt = LatticeValue(column, row, seed + 2) > 0.9F ? 0.6F : 1.0F;
    const float grain =
        1 + 0.2F * TiledFbm(x, y, 90, 4, seed + 3, 0.8F) + 0.1F * TiledFbm(x, y, 3, 4, seed + 5);
    Rgba face = (shade * burnt * grain) * brick;
    face.g *= 0.9F + 0.25F * LatticeValue(column, row, seed + 4);
    const Rgba joint = (0.85F + 0.2F * TiledFbm(x, y, 64, 4, seed + 6)) * mortar;
    return Mix(joint, face, SmoothStep(0.003F, 0.009F, edge));
  });
}

Texture PaintPlaster(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    float value = 0.7F * (1 + 0.06F * TiledFbm(x, y, 120, 2, seed, 0.9F) +
                          0.08F * TiledFbm(x, y, 2, 7, seed + 1, 0.6F));
    // Streaks left by rain: noise stretched along y.
    const float streak = TiledFbm(x, 0.125F * y, 16, 4, seed + 2, 0.7F);
    value *= 1 - 0.14F * SmoothStep(0.1F, 1, streak);
    // The edge of a repaired area appears as a faint ridge.
    const float mend = TiledFbm(x, y, 3, 6, seed + 3, 0.55F);
    if (mend > 0.62F) value *= 0.94F;
    value *= 1 - 0.12F * (1 - SmoothStep(0.0F, 0.03F, std::abs(mend - 0.62F)));
    const float soot = 0.03F * TiledFbm(x, y, 5, 4, seed + 5);
    return Rgba{value * (1 + soot), value * 0.985F, value * (0.95F - soot), 1};
  });
}

Texture PaintAshlar(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kColumns = 5;
    constexpr int kRows = 10;
    const int row = static_cast<int>(y * kRows);
    const float shifted = x * kColumns + (row % 2 == 0 ? 0.0F : 0.5F);
    const int column = static_cast<int>(shifted) % kColumns;
    const float u = (shifted - std::floor(shifted)) * 0.8F;
    const float v = (y * kRows - static_cast<float>(row)) * 0.4F;
    const float edge = std::min(std::min(u, 0.8F - u), std::min(v, 0.4F - v)) +
                       0.003F * TiledFbm(x, y, 64, 3, seed);
    float value = 0.55F * (0.82F + 0.3F * LatticeValue(column, row, seed + 1));
    value *=
        1 + 0.10F * TiledFbm(x, y, 60, 5, seed + 2, 0.8F) + 0.12F * TiledFbm(x, y, 3, 5, seed + 3);
    value *= 0.45F + 0.55F * SmoothStep(0.003F, 0.014F, edge);
    const float tone = 0.06F * (LatticeValue(column, row, seed + 4) - 0.5F);
    return Rgba{value * (1.04F + tone), value, value * (0.86F - tone), 1};
  });
}

Texture PaintRoofTiles(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kColumns = 18;
    constexpr int kRows = 12;
    const int row = static_cast<int>(y * kRows);
    const int column = static_cast<int>(x * kColumns);
    const float u = x * kColumns - static_cast<float>(column);
    const float v = y * kRows - static_cast<float>(row);
    const float curve = 0.55F + 0.45F * std::sin(u * 6.2831853F);
    const float overlap = SmoothStep(0, 0.12F, v) * (1 - 0.25F * v);
    const float shade = 0.7F + 0.5F * LatticeValue(column, row, seed);
    const float moss = SmoothStep(0.2F, 0.9F, TiledFbm(x, y, 4, 6, seed + 1, 0.7F));
    const Rgba clay =
        Mix(Srgb(168, 92, 62), Srgb(120, 66, 52), LatticeValue(column, row, seed + 2));
    const Rgba colour = Mix(clay, Srgb(88, 86, 62), 0.6F * moss);
    return (shade * overlap * (0.5F + 0.6F * curve) *
            (1 + 0.12F * TiledFbm(x, y, 60, 3, seed + 3))) *
           colour;
  });
}

Texture PaintSlates(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kColumns = 20;
    constexpr int kRows = 18;
    const int row = static_cast<int>(y * kRows);
    const float shifted = x * kColumns + (row % 2 == 0 ? 0.0F : 0.5F);
    const int column = static_cast<int>(shifted) % kColumns;
    const float u = shifted - std::floor(shifted);
    const float v = y * kRows - static_cast<float>(row);
    const float gap = SmoothStep(0.0F, 0.06F, std::min(u, 1 - u));
    const float overlap = SmoothStep(0, 0.1F, v) * (1 - 0.12F * v);
    const float shade = 0.65F + 0.6F * LatticeValue(column, row, seed);
    const float lichen = SmoothStep(0.3F, 1.0F, TiledFbm(x, y, 4, 7, seed + 1, 0.7F));
    const Rgba stone = Mix(Srgb(84, 88, 96), Srgb(98, 88, 98), LatticeValue(column, row, seed + 2));
    return (shade * overlap * (0.5F + 0.5F * gap) * (1 + 0.1F * TiledFbm(x, y, 80, 3, seed + 3))) *
           Mix(stone, Srgb(120, 118, 92), 0.5F * lichen);
  });
}

Texture PaintGravel(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    const Cell stone = TiledCells(x, y, 110, seed);
    const float shade = static_cast<float>(stone.id & 255U) / 255;
    const float value = (0.15F + 0.3F * shade) *
                        (1 - 0.6F * SmoothStep(0.2F, 0.7F, stone.nearest)) *
                        (1 + 0.2F * TiledFbm(x, y, 3, 5, seed + 1));
    return Rgba{value * 1.03F, value, value * 0.94F, 1};
  });
}

Texture PaintBlotches(uint32_t seed) {
  return Texture::Paint(1024, [seed](float x, float y) {
    const auto channel = [&](uint32_t k) {
      return std::clamp(0.5F + 0.27F * TiledFbm(x, y, 6, 8, seed + 100 * k, 0.62F), 0.0F, 1.0F);
    };
    return Rgba{channel(1), channel(2), channel(3), channel(4)};
  });
}

Texture PaintPlain(uint32_t seed) {
  return Texture::Paint(256, [seed](float x, float y) {
    const float value = 0.8F * (1 + 0.05F * TiledFbm(x, y, 4, 6, seed, 0.8F));
    return Rgba{value, value, value, 1};
  });
}

}  // namespace orb360::town
