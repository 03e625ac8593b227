#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint_rooms.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

float Fraction(float x) { return x - std::floor(x); }

Rgba DrawColour(Random& random, double low, double high) {
  const auto channel = [&] { return static_cast<float>(random.Uniform(low, high)); };
  const float grey = channel();
  const Rgba colour{channel(), channel(), channel(), 1};
  return Mix({grey, grey, grey, 1}, colour, static_cast<float>(random.Uniform(0.3, 1)));
}

/// A rectangle of print with a colour.
struct Patch {
  float x0, x1, y0, y1;
  Rgba colour;
  bool is_round;

  bool Contains(float x, float y) const {
    if (!is_round) return x > x0 && x < x1 && y > y0 && y < y1;
    const float dx = (2 * x - x0 - x1) / (x1 - x0);
    const float dy = (2 * y - y0 - y1) / (y1 - y0);
    return dx * dx + dy * dy < 1;
  }
};

std::vector<Patch> DrawPatches(Random& random, int count) {
  std::vector<Patch> patches;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(random.Uniform(-0.1, 0.9));
    const auto y = static_cast<float>(random.Uniform(-0.1, 0.9));
    patches.push_back({x, x + static_cast<float>(random.Uniform(0.05, 0.5)), y,
                       y + static_cast<float>(random.Uniform(0.05, 0.5)),
                       DrawColour(random, 0.02, 0.75), random.Chance(0.5)});
  }
  return patches;
}

}  // namespace

Texture PaintVeneer(uint32_t seed) {
  return Texture::Paint(512, [seed](float x, float y) {
    const float bend = TiledFbm(x, Fraction(y), 3, 4, seed);
    const float rings = std::sin(6.2831853F * (9 * x + 1.5F * bend));
    const float pores = TiledFbm(x, Fraction(y), 100, 2, seed + 1, 0.8F);
    const float streak = LatticeValue(static_cast<int>(x * 256), 0, seed + 2);
    const float value = 0.72F * (1 + 0.1F * rings * rings * rings + 0.12F * bend + 0.05F * pores +
                                 0.1F * (streak - 0.5F));
    return Rgba{value, 0.97F * value, 0.92F * value, 1};
  });
}

Texture PaintCloth(uint32_t seed, const Rgba& ground, const Rgba& figure) {
  Random random(seed);
  const int pattern = random.Int(5);
  const int repeats = 4 + random.Int(8);
  return Texture::Paint(256, [=](float x, float y) {
    const float u = Fraction(x * static_cast<float>(repeats));
    const float v = Fraction(y * static_cast<float>(repeats));
    float ink = 0;
    if (pattern == 1) ink = u < 0.35F ? 1.0F : 0.0F;
    if (pattern == 2) ink = 0.5F * ((u < 0.5F ? 1.0F : 0.0F) + (v < 0.5F ? 1.0F : 0.0F));
    if (pattern == 3) {
      const Cell flower = TiledCells(x, y, 2 * repeats, seed + 1);
      ink = flower.id % 2 == 0 ? 1 - SmoothStep(0.2F, 0.3F, flower.nearest) : 0.0F;
    }
    const float thread = 0.5F * (std::sin(6.2831853F * 80 * x) + std::sin(6.2831853F * 80 * y));
    const float value = 1 + 0.08F * thread + 0.1F * TiledFbm(x, y, 3, 6, seed + 2, 0.7F);
    return value * Mix(ground, figure, 0.8F * ink);
  });
}

Texture PaintBooks(uint32_t seed) {
  Random random(seed);
  struct Spine {
    float end;     // in tiles
    float height;  // likewise
    Rgba colour;
    Rgba print;
    float label, label_end;
  };
  std::vector<Spine> spines;
  float end = 0;
  std::vector<float> begins;
  float width = 0;  // in tiles
  while (end < 1) {
    const bool of_series = !spines.empty() && random.Chance(0.4);
    Spine spine = of_series ? spines.back()
                            : Spine{0,
                                    static_cast<float>(random.Uniform(0.62, 0.97)),
                                    DrawColour(random, 0.01, 0.5),
                                    DrawColour(random, 0.3, 0.8),
                                    static_cast<float>(random.Uniform(0.3, 0.6)),
                                    0};
    if (!of_series) {
      spine.label_end = spine.label + static_cast<float>(random.Uniform(0.08, 0.3));
      width = static_cast<float>(random.Uniform(0.015, 0.06));
    }
    begins.push_back(end);
    end += width;
    spine.end = end;
    spines.push_back(spine);
  }
  return Texture::Paint(256, [=](float x, float y) {
    size_t i = 0;
    while (i + 1 < spines.size() && spines[i].end < x) ++i;
    const Spine& spine = spines[i];
    if (y > spine.height) return Rgba{0.02F, 0.018F, 0.015F, 1};
    const float u = (x - begins[i]) / (spine.end - begins[i]);
    const float round = 0.45F + 0.55F * std::sqrt(std::max(0.0F, 4 * u * (1 - u)));
    const bool is_label = y > spine.label && y < spine.label_end && u > 0.15F && u < 0.85F;
    const bool is_line = LatticeValue(static_cast<int>(90 * y), static_cast<int>(i), seed) > 0.5F;
    const Rgba colour =
        is_label ? (is_line ? spine.print : Mix(spine.colour, spine.print, 0.3F)) : spine.colour;
    return (round * (1 + 0.15F * TiledFbm(x, y, 20, 4, seed + 1))) * colour;
  });
}

Texture PaintCarton(uint32_t seed) {
  Random random(seed);
  const Rgba brown = static_cast<float>(random.Uniform(0.7, 1.2)) * Rgba{0.36F, 0.24F, 0.13F, 1};
  const Rgba colour = random.Chance(0.75) ? brown : DrawColour(random, 0.1, 0.7);
  const bool has_tape = random.Chance(0.7);
  const auto label_x = static_cast<float>(random.Uniform(0.1, 0.6));
  const auto label_y = static_cast<float>(random.Uniform(0.1, 0.6));
  const bool has_label = random.Chance(0.6);
  const Rgba ink = DrawColour(random, 0.02, 0.3);
  const std::vector<Patch> prints = DrawPatches(random, 1 + random.Int(3));
  return Texture::Paint(128, [=](float x, float y) {
    const float flute = 0.03F * std::sin(6.2831853F * 40 * x);
    Rgba c = (1 + flute + 0.15F * TiledFbm(x, y, 3, 6, seed, 0.6F)) * colour;
    for (const Patch& print : prints) {
      if (print.Contains(x, y) &&
          LatticeValue(static_cast<int>(30 * x), static_cast<int>(20 * y), seed + 1) > 0.6F)
        c = Mix(c, ink, 0.6F);
    }
    if (has_tape && std::abs(x - 0.5F) < 0.06F) c = Mix(c, {0.5F, 0.4F, 0.26F, 1}, 0.6F);
    if (has_label && x > label_x && x < label_x + 0.3F && y > label_y && y < label_y + 0.22F) {
      const bool text =
          LatticeValue(static_cast<int>(60 * x), static_cast<int>(36 * y), seed + 2) > 0.62F;
      c = text ? Rgba{0.05F, 0.05F, 0.05F, 1} : Rgba{0.7F, 0.7F, 0.68F, 1};
    }
    const float edge = std::min(std::min(x, 1 - x), std::min(y, 1 - y));
    return (0.75F + 0.25F * SmoothStep(0, 0.03F, edge)) * c;
  });
}

Texture PaintPicture(uint32_t seed) {
  Random random(seed);
  const bool is_landscape = random.Chance(0.5);
  const std::array<Rgba, 4> tones = {DrawColour(random, 0.2, 0.8), DrawColour(random, 0.05, 0.5),
                                     DrawColour(random, 0.02, 0.3), DrawColour(random, 0.05, 0.6)};
  const auto horizon = static_cast<float>(random.Uniform(0.3, 0.65));
  const auto mount = static_cast<float>(random.Uniform(0.0, 0.16));
  const std::vector<Patch> patches = DrawPatches(random, 4 + random.Int(14));
  return Texture::Paint(256, [=](float x, float y) {
    if (std::min(std::min(x, 1 - x), std::min(y, 1 - y)) < mount)
      return Rgba{0.72F, 0.7F, 0.64F, 1};
    const float brush = 1 + 0.25F * TiledFbm(x, y, 24, 4, seed, 0.7F);
    Rgba c;
    if (is_landscape) {
      const float ridge = horizon + 0.12F * TiledFbm(x, 0.5F, 3, 5, seed + 1);
      const float near = 0.5F * horizon + 0.1F * TiledFbm(x, 0.2F, 4, 5, seed + 2);
      c = y > ridge ? Mix(tones[3], tones[0], Fraction(y) * 0.9F) : y > near ? tones[1] : tones[2];
      c = (1 + 0.5F * TiledFbm(x, y, 5, 6, seed + 3, 0.65F)) * c;
    } else {
      c = (1 + 0.3F * TiledFbm(x, y, 3, 5, seed + 4)) * tones[0];
      for (const Patch& patch : patches) {
        if (patch.Contains(x, y)) c = patch.colour;
      }
    }
    return brush * c;
  });
}

Texture PaintScreen(uint32_t seed) {
  Random random(seed);
  std::vector<Patch> windows = DrawPatches(random, 3);
  for (Patch& window : windows) {
    window.is_round = false;
    window.colour = random.Chance(0.7) ? Rgba{0.75F, 0.77F, 0.8F, 1} : Rgba{0.03F, 0.03F, 0.04F, 1};
  }
  const Rgba desktop = DrawColour(random, 0.03, 0.4);
  return Texture::Paint(128, [=](float x, float y) {
    if (std::min(std::min(x, 1 - x), std::min(y, 1 - y)) < 0.03F)
      return Rgba{0.015F, 0.015F, 0.015F, 1};
    Rgba c = (0.8F + 0.4F * y) * desktop;
    for (const Patch& window : windows) {
      if (!window.Contains(x, y)) continue;
      const int line = static_cast<int>(40 * y);
      const bool text = line % 2 == 0 && x > window.x0 + 0.03F &&
                        LatticeValue(static_cast<int>(64 * x), line, seed) > 0.4F;
      c = text ? Rgba{0.3F, 0.32F, 0.35F, 1} : window.colour;
    }
    return c;
  });
}

}  // namespace orb360::town
