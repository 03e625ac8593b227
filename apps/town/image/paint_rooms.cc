#include "apps/town/image/paint_rooms.h"

#include <algorithm>
#include <cmath>

#include "apps/town/image/noise.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

constexpr float kTurn = 6.2831853F;  // radians

float Fraction(float x) { return x - std::floor(x); }

/// Hides the seam of noise that is stretched along y and therefore does not tile.
float Fade(float y) { return SmoothStep(0, 0.12F, y) * SmoothStep(0, 0.12F, 1 - y); }

/// Grain of wood along y at (u, v) metres: rings cut at a flat angle, and pores.
float Grain(float u, float v, uint32_t seed) {
  const float bend = TiledFbm(Fraction(0.5F * u), Fraction(0.12F * v), 6, 4, seed);
  const float rings = std::sin(kTurn * (14 * u + 1.8F * bend));
  const float pores = TiledFbm(Fraction(u), Fraction(0.08F * v), 96, 3, seed + 1, 0.8F);
  return 0.10F * rings * rings * rings + 0.14F * bend + 0.09F * pores;
}

/// A scuff or a stain: a few blobs of noise above a threshold.
float Stain(float x, float y, int frequency, float threshold, uint32_t seed) {
  return SmoothStep(threshold, threshold + 0.35F, TiledFbm(x, y, frequency, 6, seed, 0.6F));
}

}  // namespace

Texture PaintWallPaint(uint32_t seed, float worn) {
  return Texture::Paint(512, [=](float x, float y) {
    float value = 0.8F * (1 + 0.022F * TiledFbm(x, y, 128, 2, seed, 0.9F) +
                          0.035F * TiledFbm(x, y, 2, 8, seed + 1, 0.62F));
    // The roller leaves bands.
    value *= 1 + 0.010F * Fade(y) * TiledFbm(x, Fraction(0.1F * y), 18, 2, seed + 2);
    value *= 1 - 0.22F * worn * Stain(x, y, 4, 0.25F, seed + 3);
    const float mend = TiledFbm(x, y, 3, 3, seed + 4);
    if (mend > 0.75F - 0.3F * worn) value *= 1 - 0.04F * worn;
    const float scuff = TiledFbm(Fraction(0.2F * x), y, 50, 3, seed + 5, 0.7F);
    value *= 1 - 0.3F * worn * Fade(x) * SmoothStep(0.62F, 0.8F, scuff);
    const Cell hole = TiledCells(x, y, 9, seed + 6);
    if (hole.id % 5 == 0) value *= 1 - 0.5F * worn * (1 - SmoothStep(0.01F, 0.025F, hole.nearest));
    const float tone = 0.02F * TiledFbm(x, y, 3, 4, seed + 7);
    return Rgba{value * (1 + tone), value, value * (0.985F - tone), 1};
  });
}

Texture PaintWallpaper(uint32_t seed, const Rgba& ground, const Rgba& figure) {
  Random random(seed);
  const int kind = random.Int(3);
  const int repeats = 3 + random.Int(5);
  const auto width = static_cast<float>(random.Uniform(0.15, 0.5));
  return Texture::Paint(512, [=](float x, float y) {
    const float u = Fraction(x * static_cast<float>(repeats));
    const float v = Fraction(y * static_cast<float>(repeats));
    float ink = 0;
    if (kind == 0) {  // stripes with thin lines beside them
      const float from_middle = std::abs(u - 0.5F);
      ink = 1 - SmoothStep(0.5F * width - 0.01F, 0.5F * width + 0.01F, from_middle);
      ink = std::max(ink,
                     1 - SmoothStep(0.008F, 0.016F, std::abs(from_middle - 0.5F * width - 0.05F)));
    } else if (kind == 1) {  // an ornament with mirror symmetry, in staggered rows
      const float staggered =
          Fraction(v + (Fraction(x * static_cast<float>(repeats) / 2) < 0.5F ? 0.0F : 0.5F));
      const float mirrored = std::abs(u - 0.5F);
      const float shape =
          TiledFbm(mirrored, staggered, 4, 3, seed + 1, 0.5F) + 0.35F - 1.1F * mirrored;
      ink = SmoothStep(0.02F, 0.06F, std::abs(shape)) < 0.5F ? 0.75F
                                                             : SmoothStep(0.12F, 0.18F, shape);
    } else {  // flowers
      const Cell flower = TiledCells(x, y, 2 * repeats, seed + 2);
      const float angle = std::atan2(Fraction(31.7F * x) - 0.5F, Fraction(29.3F * y) - 0.5F);
      const float petal = 0.22F + 0.05F * std::sin(5 * angle);
      if (flower.id % 3 != 0) ink = 1 - SmoothStep(petal - 0.03F, petal, flower.nearest);
      ink = std::max(ink, 0.5F * (1 - SmoothStep(0.02F, 0.05F, flower.second - flower.nearest)));
    }
    const float grain =
        1 + 0.04F * TiledFbm(x, y, 128, 2, seed + 3, 0.8F) + 0.05F * TiledFbm(x, y, 2, 6, seed + 4);
    return grain * Mix(ground, figure, 0.8F * ink);
  });
}

Texture PaintCeilingPanels(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    constexpr int kPanels = 4;
    const float u = Fraction(x * kPanels);
    const float v = Fraction(y * kPanels);
    const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v)) * 0.6F;  // metres
    const float shade =
        LatticeValue(static_cast<int>(x * kPanels), static_cast<int>(y * kPanels), seed);
    const Cell hole = TiledCells(x, y, 110, seed + 1);
    float value = 0.74F * (0.96F + 0.06F * shade);
    if (hole.id % 3 == 0) value *= 1 - 0.4F * (1 - SmoothStep(0.15F, 0.3F, hole.nearest));
    value *= 1 + 0.05F * TiledFbm(x, y, 60, 3, seed + 2);
    if (shade > 0.93F) value *= 1 - 0.25F * Stain(x, y, 6, 0, seed + 3);
    if (edge < 0.012F) value = 0.8F;
    value *= 1 - 0.45F * (1 - SmoothStep(0.0F, 0.004F, std::abs(edge - 0.014F)));
    return Rgba{value, 0.99F * value, 0.96F * value, 1};
  });
}

Texture PaintPlanks(uint32_t seed, int rows, const Rgba& wood) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float across = x * static_cast<float>(rows);
    const int row = static_cast<int>(across);
    const int boards = 2 + static_cast<int>(2 * LatticeValue(row, 7, seed));
    const float along = Fraction(y + LatticeValue(row, 3, seed)) * static_cast<float>(boards);
    const int board = static_cast<int>(along);
    const float u = Fraction(across) * 2 / static_cast<float>(rows);  // metres
    const float v = Fraction(along) * 2 / static_cast<float>(boards);
    const float edge = std::min(std::min(u, 2 / static_cast<float>(rows) - u),
                                std::min(v, 2 / static_cast<float>(boards) - v));
    const float shift = 7 * LatticeValue(row, board, seed + 1);
    const float shade = 0.72F + 0.5F * LatticeValue(row, board, seed + 2);
    const float wear =
        1 + 0.12F * TiledFbm(x, y, 2, 7, seed + 3, 0.6F) - 0.12F * Stain(x, y, 3, 0.3F, seed + 5);
    const float gap = 0.35F + 0.65F * SmoothStep(0.0005F, 0.003F, edge);
    const float grain = 1 + 1.3F * Grain(u + shift, v + shift, seed + 4);
    Rgba colour = (shade * wear * gap * grain) * wood;
    colour.b *= 0.85F + 0.3F * LatticeValue(row, board, seed + 6);
    return colour;
  });
}

Texture PaintHerringbone(uint32_t seed, const Rgba& wood) {
  return Texture::Paint(1024, [=](float x, float y) {
    // Staves of 1 x 4 units on a lattice of 16 x 16: cell (i, j) belongs to an upright stave where
    // (i - j) mod 8 is at least 4, and to a lying one elsewhere.
    constexpr int kCells = 16;
    const float fx = x * kCells;
    const float fy = y * kCells;
    const int i = static_cast<int>(fx);
    const int j = static_cast<int>(fy);
    const int phase = ((i - j) % 8 + 8) % 8;
    const bool lies = phase < 4;
    const int position = lies ? phase : 7 - phase;
    const float across = lies ? Fraction(fy) : Fraction(fx);
    const float along = (static_cast<float>(position) + (lies ? Fraction(fx) : Fraction(fy)));
    const int a = lies ? (i - position + kCells) % kCells : i;
    const int b = lies ? j : (j - position + kCells) % kCells;
    const float edge = std::min(std::min(across, 1 - across), std::min(along, 4 - along));
    const float shade = 0.72F + 0.5F * LatticeValue(a, b, seed + (lies ? 0 : 9));
    const float shift = 5 * LatticeValue(a, b, seed + 1);
    const float grain = 1 + 1.3F * Grain(0.1F * across + shift, 0.1F * along + shift, seed + 2);
    const float wear = 1 + 0.12F * TiledFbm(x, y, 2, 7, seed + 3, 0.6F);
    return (shade * grain * wear * (0.4F + 0.6F * SmoothStep(0.01F, 0.035F, edge))) * wood;
  });
}

Texture PaintTiles(uint32_t seed, int columns, int rows, const Rgba& tile, const Rgba& other,
                   bool chequered) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float fx = x * static_cast<float>(columns);
    const float fy = y * static_cast<float>(rows);
    const int i = static_cast<int>(fx);
    const int j = static_cast<int>(fy);
    const float u = Fraction(fx);
    const float v = Fraction(fy);
    const float edge = std::min(std::min(u, 1 - u) * 2 / static_cast<float>(columns),
                                std::min(v, 1 - v) * 2 / static_cast<float>(rows));  // metres
    const bool is_other = chequered ? (i + j) % 2 != 0 : LatticeValue(i, j, seed) > 0.93F;
    const float shade = 0.92F + 0.14F * LatticeValue(i, j, seed + 1);
    const float glaze =
        1 + 0.05F * TiledFbm(x, y, 12, 5, seed + 2, 0.6F) + 0.03F * TiledFbm(x, y, 2, 3, seed + 3);
    const Rgba face = (shade * glaze) * (is_other ? other : tile);
    const float dirt = 0.55F + 0.35F * TiledFbm(x, y, 3, 6, seed + 4, 0.6F);
    const Rgba grout = (0.45F * dirt + 0.18F) * Rgba{0.8F, 0.77F, 0.7F, 1};
    return Mix(grout, face, SmoothStep(0.0012F, 0.0032F, edge));
  });
}

Texture PaintTerrazzo(uint32_t seed, const Rgba& ground) {
  return Texture::Paint(1024, [=](float x, float y) {
    const Cell large = TiledCells(x, y, 70, seed);
    const Cell small = TiledCells(x, y, 180, seed + 1);
    float value = 1 + 0.1F * TiledFbm(x, y, 3, 7, seed + 2, 0.6F);
    if (large.id % 3 == 0 && large.nearest < 0.32F)
      value *= 0.6F + 0.7F * static_cast<float>(large.id >> 8 & 255U) / 255;
    else if (small.id % 2 == 0 && small.nearest < 0.35F)
      value *= 0.8F + 0.35F * static_cast<float>(small.id >> 8 & 255U) / 255;
    value *= 1 - 0.18F * Stain(x, y, 3, 0.2F, seed + 3);
    const float heel = TiledFbm(Fraction(0.3F * x), y, 40, 3, seed + 4, 0.7F);
    value *= 1 - 0.35F * Fade(x) * SmoothStep(0.66F, 0.78F, heel);
    return value * ground;
  });
}

Texture PaintCarpet(uint32_t seed, const Rgba& pile) {
  Random random(seed);
  const int pattern = random.Int(3);
  const Rgba second = Mix(pile, {0.5F, 0.45F, 0.4F, 1}, 0.5F);
  return Texture::Paint(512, [=](float x, float y) {
    float value =
        0.85F + 0.35F * LatticeValue(static_cast<int>(512 * x), static_cast<int>(512 * y), seed);
    value *= 1 + 0.12F * TiledFbm(x, y, 2, 8, seed + 1, 0.65F);
    value *= 1 - 0.25F * Stain(x, y, 4, 0.3F, seed + 2);
    float ink = 0;
    if (pattern == 0) ink = TiledFbm(x, y, 40, 2, seed + 3) > 0.25F ? 0.22F : 0.0F;
    if (pattern == 1) ink = Fraction(8 * x) < 0.08F || Fraction(8 * y) < 0.08F ? 0.5F : 0.0F;
    return value * Mix(pile, second, ink);
  });
}

Texture PaintScreed(uint32_t seed) {
  return Texture::Paint(1024, [seed](float x, float y) {
    float value = 0.3F * (1 + 0.14F * TiledFbm(x, y, 2, 9, seed, 0.65F));
    const Cell slab = TiledCells(Fraction(x + 0.05F * TiledFbm(x, y, 4, 4, seed + 1)),
                                 Fraction(y + 0.05F * TiledFbm(x, y, 4, 4, seed + 2)), 3, seed + 3);
    value *= 1 - 0.5F * (1 - SmoothStep(0.0F, 0.008F, slab.second - slab.nearest));
    const float tyre = TiledFbm(x, Fraction(0.12F * y), 12, 3, seed + 4, 0.6F);
    value *= 1 - 0.35F * Fade(y) * SmoothStep(0.3F, 0.7F, tyre) *
                     (0.7F + 0.3F * TiledFbm(x, y, 20, 3, seed + 5));
    const Cell drip = TiledCells(x, y, 12, seed + 6);
    const float radius = 0.08F + 0.25F * static_cast<float>(drip.id >> 8 & 255U) / 255;
    const float ragged = drip.nearest + 0.1F * TiledFbm(x, y, 30, 3, seed + 7);
    if (drip.id % 5 == 0)
      value *= 1 - (0.15F + 0.3F * radius) * (1 - SmoothStep(0.4F * radius, radius, ragged));
    return Rgba{1.02F * value, value, 0.94F * value, 1};
  });
}

}  // namespace orb360::town
