#include "apps/town/image/paint_nature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "apps/town/image/noise.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float Bits(uint32_t id, int shift) { return static_cast<float>(id >> shift & 255U) / 255; }

/// An oval leaf at a point: 0 outside, up to 1 on its middle.
struct FallenLeaf {
  float inside = 0;
  uint32_t id = 0;
};

/// Returns the leaf of a layer, of which there are four with leaves in different directions.
FallenLeaf LeafAt(float x, float y, int frequency, uint32_t layer, uint32_t seed) {
  // Maps of the unit tile onto itself that stretch the cells of the noise.
  const std::array<std::array<float, 2>, 4> maps = {
      {{2 * x, y}, {x, 2 * y}, {x + y, 2 * (x - y)}, {2 * (x + y), x - y}}};
  const float u = maps[layer % 4][0] - std::floor(maps[layer % 4][0]);
  const float v = maps[layer % 4][1] - std::floor(maps[layer % 4][1]);
  const Cell cell = TiledCells(u, v, frequency, seed + 7 * layer);
  const float size = 0.22F + 0.26F * Bits(cell.id, 8);
  const float outline = 0.1F * TiledFbm(x, y, 3 * frequency, 2, seed + 5);
  return {1 - SmoothStep(0.7F * size, size, cell.nearest + outline), cell.id};
}

/// Colours of leaves that lie on the ground.
const std::array<Rgba, 6> kFallen = {Srgb(110, 88, 66), Srgb(92, 72, 54),  Srgb(134, 112, 80),
                                     Srgb(82, 68, 56),  Srgb(120, 94, 66), Srgb(104, 96, 78)};

/// Lines in all directions: 1 on a line, 0 beside it.
float Twigs(float x, float y, int frequency, uint32_t seed) {
  float most = 0;
  for (uint32_t k = 0; k < 2; ++k) {
    // Ridges of noise stretched along x, and along y.
    const float u = k == 0 ? x : 0.125F * x;
    const float v = k == 0 ? 0.125F * y : y;
    const float ridge = std::abs(TiledFbm(u, v, frequency, 2, seed + 7 * k, 0.4F));
    const float here = SmoothStep(0.1F, 0.4F, TiledFbm(x, y, frequency / 4, 2, seed + 20 + k));
    most = std::max(most, here * (1 - SmoothStep(0.02F, 0.07F, ridge)));
  }
  return most;
}

/// A branch with twigs on both sides, each with needles or leaflets on both of its sides.
struct Spray {
  int twigs = 20;        ///< on each side
  float reach = 0.45F;   ///< length of the longest twig, in tiles
  float angle = 0.9F;    ///< radians between branch and twigs
  float needle = 0.03F;  ///< length of a needle, in tiles
  float pitch = 0.014F;  ///< between needles, in tiles
  float taper = 1;       ///< exponent with which twigs become shorter towards the tip
};

Texture PaintSpray(uint32_t seed, const Spray& spray, const Rgba& low, const Rgba& high,
                   const Rgba& stalk) {
  struct Twig {
    float at, side, length, angle, shade;
  };
  Random random(seed);
  std::vector<Twig> twigs;
  for (int i = 0; i < 2 * spray.twigs; ++i) {
    const float t = (static_cast<float>(i) + 0.5F) / static_cast<float>(2 * spray.twigs);
    const float length = spray.reach * std::pow(1 - t, spray.taper) *
                         static_cast<float>(random.Uniform(0.75, 1)) * SmoothStep(-0.1F, 0.12F, t);
    twigs.push_back({0.02F + 0.93F * t, i % 2 == 0 ? 1.0F : -1.0F, length,
                     spray.angle * static_cast<float>(random.Uniform(0.85, 1.15)),
                     static_cast<float>(random.Uniform(0.7, 1.2))});
  }
  return Texture::Paint(256, [=](float x, float y) {
    Rgba colour = Mix(low, high, 0.5F);
    colour.a = 0;
    const float dx = x - 0.5F - 0.015F * std::sin(3 * y + static_cast<float>(seed % 7));
    if (std::abs(dx) < 0.008F * (1.3F - y) && y < 0.97F) colour = stalk;
    for (const Twig& twig : twigs) {
      const float c = std::cos(twig.angle);
      const float s = std::sin(twig.angle) * twig.side;
      // Twigs bend towards the tip of the branch.
      const float along = dx * s + (y - twig.at) * c;
      if (along < 0 || along > twig.length) continue;
      const float bend = 0.25F * along * along / (twig.length + 0.02F);
      const float across = dx * c * twig.side - (y - twig.at) * std::abs(s) + bend;
      const float t = along / (twig.length + 1e-6F);
      const float half_width = spray.needle * std::sqrt(1 - t) * std::min(1.0F, 6 * t + 0.4F);
      if (std::abs(across) > half_width) continue;
      if (std::abs(across) < 0.0035F) {
        colour = twig.shade * stalk;
        continue;
      }
      const float stripe = (along - 0.8F * std::abs(across)) / spray.pitch;
      if (stripe - std::floor(stripe) > 0.72F) continue;
      colour = (twig.shade * (0.8F + 0.3F * t)) *
               Mix(low, high, std::abs(across) / (half_width + 1e-6F));
    }
    return colour;
  });
}

}  // namespace

Texture PaintForestFloor(uint32_t seed, float leaves, float moss) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float rough = TiledFbm(x, y, 6, 7, seed, 0.75F);
    Rgba colour = Mix(Srgb(62, 48, 36), Srgb(98, 78, 58), 0.5F + 0.5F * rough);
    // Needles and crumbs, a few millimetres long.
    const float crumbs = std::max(TiledFbm(x, 0.25F * y, 256, 2, seed + 1, 0.9F),
                                  TiledFbm(0.25F * x, y, 256, 2, seed + 2, 0.9F));
    colour = (0.75F + 0.5F * crumbs) * colour;
    for (uint32_t layer = 0; layer < 8; ++layer) {
      const int frequency = 36 + 5 * static_cast<int>(layer);
      const FallenLeaf leaf = LeafAt(x, y, frequency, layer, seed + 10);
      const float cover = leaves + 0.4F * TiledFbm(x, y, 4, 3, seed + 40);
      if (Bits(leaf.id, 16) > cover || leaf.inside <= 0) continue;
      const Rgba own = (0.65F + 0.5F * Bits(leaf.id, 24)) * kFallen[leaf.id % kFallen.size()];
      // Its edge lies in a thin shadow.
      colour = Mix(0.7F * colour, (0.75F + 0.25F * leaf.inside) * own, leaf.inside);
    }
    colour = Mix(colour, Srgb(76, 58, 42), 0.9F * Twigs(x, y, 24, seed + 50));
    const float soft =
        SmoothStep(0.9F - 1.4F * moss, 1.3F - 1.4F * moss, TiledFbm(x, y, 5, 6, seed + 60, 0.6F));
    const Rgba green = (0.7F + 0.4F * TiledFbm(x, y, 128, 3, seed + 61, 0.8F)) *
                       Mix(Srgb(62, 72, 38), Srgb(96, 102, 58), 0.5F + 0.5F * rough);
    return Mix(colour, green, 0.9F * soft);
  });
}

Texture PaintTrail(uint32_t seed) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float rough = TiledFbm(x, y, 4, 8, seed, 0.7F);
    Rgba colour = Mix(Srgb(94, 80, 66), Srgb(132, 116, 96), 0.5F + 0.5F * rough);
    for (uint32_t layer = 0; layer < 3; ++layer) {
      const int frequency = 56 << layer;
      const Cell pebble = TiledCells(x, y, frequency, seed + 5 + layer);
      if (pebble.id % 3 != 0) continue;
      const float size =
          0.1F + 0.25F * Bits(pebble.id, 8) + 0.06F * TiledFbm(x, y, 3 * frequency, 2, seed + 15);
      const float inside = 1 - SmoothStep(0.7F * size, size, pebble.nearest);
      const float grey = 0.1F + 0.2F * Bits(pebble.id, 16);
      colour = Mix(colour, {grey * 1.05F, grey, grey * 0.9F, 1}, inside);
    }
    for (uint32_t layer = 0; layer < 4; ++layer) {
      const FallenLeaf leaf = LeafAt(x, y, 40, layer, seed + 20);
      if (leaf.id % 9 == 0)
        colour = Mix(colour, kFallen[leaf.id / 16 % kFallen.size()], leaf.inside);
    }
    return (0.85F + 0.3F * TiledFbm(x, y, 200, 2, seed + 30, 0.8F)) * colour;
  });
}

Texture PaintHeath(uint32_t seed) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float blades = std::max(TiledFbm(x, 0.25F * y, 160, 2, seed, 0.9F),
                                  TiledFbm(0.25F * x, y, 160, 2, seed + 1, 0.9F));
    const float clumps = TiledFbm(x, y, 10, 6, seed + 2, 0.7F);
    const Rgba grass = Mix(Srgb(104, 98, 68), Srgb(142, 134, 104), 0.5F + 0.5F * clumps);
    const Rgba heather = Mix(Srgb(58, 54, 44), Srgb(100, 82, 86), 0.5F + 0.5F * blades);
    Rgba colour =
        Mix(grass, heather, SmoothStep(-0.1F, 0.3F, TiledFbm(x, y, 5, 6, seed + 3, 0.65F)));
    const float bare = SmoothStep(0.6F, 0.8F, TiledFbm(x, y, 4, 6, seed + 4, 0.6F));
    colour = Mix(colour, Srgb(120, 104, 84), bare);
    const Cell stone = TiledCells(x, y, 24, seed + 5);
    if (stone.id % 13 == 0 && stone.nearest < 0.1F + 0.2F * Bits(stone.id, 8))
      return (0.7F + 0.5F * Bits(stone.id, 16)) * Srgb(134, 132, 126);
    return std::max(0.25F, 0.85F + 0.45F * blades) * colour;
  });
}

Texture PaintRock(uint32_t seed) {
  return Texture::Paint(1024, [=](float x, float y) {
    const float warp = TiledFbm(x, y, 3, 5, seed, 0.6F);
    const float layers = std::sin(2 * kPi * (7 * y + 1.2F * warp));
    const float grain = TiledFbm(x, y, 8, 8, seed + 1, 0.8F);
    float value = 0.42F * (1 + 0.14F * layers + 0.3F * grain);
    // Cracks are where cells of distorted noise meet; wide ones are darker.
    for (uint32_t k = 0; k < 2; ++k) {
      const int frequency = k == 0 ? 5 : 14;
      const float bend = 0.5F / static_cast<float>(frequency);
      const float wx = x + bend * TiledFbm(x, y, frequency, 4, seed + 2 + k);
      const float wy = y + bend * TiledFbm(x, y, frequency, 4, seed + 12 + k);
      const Cell cell =
          TiledCells(wx - std::floor(wx), wy - std::floor(wy), frequency, seed + 22 + k);
      const float facet = 0.85F + 0.3F * Bits(cell.id, 8);
      value *= facet * (1 - (k == 0 ? 0.6F : 0.35F) *
                                (1 - SmoothStep(0, 0.06F, cell.second - cell.nearest)));
    }
    const float lichen = SmoothStep(0.45F, 0.6F, TiledFbm(x, y, 7, 5, seed + 30, 0.7F));
    const float tone = 0.06F * TiledFbm(x, y, 2, 4, seed + 31);
    return Mix({value * (1 + tone), value, value * (0.95F - tone), 1},
               {1.15F * value, 1.2F * value, 0.9F * value, 1}, 0.6F * lichen);
  });
}

Texture PaintNeedleBranch(uint32_t seed) {
  Random random(seed);
  const Spray spray{14 + random.Int(8),
                    static_cast<float>(random.Uniform(0.36, 0.48)),
                    static_cast<float>(random.Uniform(0.75, 1.0)),
                    static_cast<float>(random.Uniform(0.026, 0.045)),
                    static_cast<float>(random.Uniform(0.011, 0.016)),
                    static_cast<float>(random.Uniform(0.7, 1.1))};
  return PaintSpray(seed, spray, Srgb(44, 60, 36), Srgb(84, 104, 62), Srgb(82, 62, 46));
}

Texture PaintFern(uint32_t seed) {
  const Spray spray{18, 0.34F, 1.25F, 0.022F, 0.02F, 0.85F};
  return PaintSpray(seed, spray, Srgb(70, 92, 44), Srgb(112, 132, 70), Srgb(110, 118, 60));
}

Texture PaintGrassTuft(uint32_t seed, float dry) {
  struct Blade {
    float root, lean, height, width, shade;
  };
  Random random(seed);
  std::vector<Blade> blades;
  for (int i = 0; i < 44; ++i) {
    const double root = random.Uniform(-0.12, 0.12);
    blades.push_back({static_cast<float>(0.5 + root),
                      static_cast<float>(2.2 * root + 0.16 * random.Gaussian()),
                      static_cast<float>(random.Uniform(0.4, 0.98)),
                      static_cast<float>(random.Uniform(0.006, 0.013)),
                      static_cast<float>(random.Uniform(0.6, 1.25))});
  }
  const Rgba green = Mix(Srgb(74, 96, 42), Srgb(168, 150, 100), dry);
  return Texture::Paint(256, [=](float x, float y) {
    Rgba colour{green.r, green.g, green.b, 0};
    for (const Blade& blade : blades) {
      if (y > blade.height) continue;
      const float t = y / blade.height;
      const float middle = blade.root + blade.lean * t * t;
      if (std::abs(x - middle) < blade.width * (1.05F - t))
        colour = (blade.shade * (0.6F + 0.5F * t)) * green;
    }
    return colour;
  });
}

}  // namespace orb360::town
