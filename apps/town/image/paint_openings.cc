#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

Rgba RandomColour(Random& random, float low, float high) {
  const auto channel = [&] { return static_cast<float>(random.Uniform(low, high)); };
  const float r = channel();
  const float g = channel();
  const float b = channel();
  return {r, g, b, 1};
}

}  // namespace

Texture PaintRoom(uint32_t seed) {
  Random random(seed);
  enum Dressing { kBare, kCurtains, kOneCurtain, kBlind, kNet, kRollerBlind, kCafeCurtain };
  static constexpr std::array<Dressing, 10> kDressings = {
      kBare,  kBare, kCurtains, kCurtains,    kOneCurtain,
      kBlind, kNet,  kNet,      kRollerBlind, kCafeCurtain};
  const Dressing dressing = random.Pick(std::span<const Dressing>(kDressings));
  const Rgba wall = 0.3F * RandomColour(random, 0.25F, 0.7F);
  const bool pale = random.Chance(0.6);
  const Rgba curtain = RandomColour(random, pale ? 0.6F : 0.15F, pale ? 0.85F : 0.6F);
  const auto open = static_cast<float>(random.Uniform(0.12, 0.4));
  const auto drop = static_cast<float>(random.Uniform(0.15, 0.95));
  const auto lamp_x = static_cast<float>(random.Uniform(0.25, 0.75));
  const bool lamp = random.Chance(0.25);
  const bool plant = random.Chance(0.35);
  const auto plant_x = static_cast<float>(random.Uniform(0.2, 0.8));
  const bool shelf = random.Chance(0.4);
  const bool painting = random.Chance(0.4);
  const float folds = static_cast<float>(9 + random.Int(9));
  return Texture::Paint(128, [=](float x, float y) {
    // The room darkens with depth; objects at the far wall are faintly visible.
    const float far = 0.2F + 0.5F * y + 0.12F * TiledFbm(x, y, 3, 4, seed);
    Rgba colour = (0.35F * far) * wall;
    if (y > 0.86F) colour = (0.5F * (1.6F - y)) * Rgba{0.3F, 0.29F, 0.27F, 1};  // the ceiling
    if (painting && std::abs(x - 0.62F) < 0.1F && std::abs(y - 0.6F) < 0.11F)
      colour = 0.08F * Rgba{0.9F, 0.8F * x, 0.6F * y, 1};
    if (shelf && x < 0.34F && y < 0.62F) {
      const int book = static_cast<int>(x * 60);
      const int board = static_cast<int>(y * 8);
      colour = (0.05F + 0.1F * LatticeValue(book, board, seed + 4)) *
               Rgba{0.9F, 0.4F + 0.5F * LatticeValue(book, board, seed + 5), 0.4F, 1};
    }
    if (lamp) {
      const float glow = std::hypot(x - lamp_x, 1.4F * (y - 0.72F));
      colour = Mix({0.75F, 0.55F, 0.3F, 1}, colour, SmoothStep(0.03F, 0.09F, glow));
    }
    if (plant) {
      const float leaf =
          std::hypot(x - plant_x, y - 0.15F) + 0.12F * TiledFbm(x, y, 10, 3, seed + 1);
      if (leaf < 0.15F)
        colour =
            (0.3F + 0.6F * LatticeValue(static_cast<int>(x * 40), static_cast<int>(y * 40), seed)) *
            Srgb(58, 84, 42);
    }
    const float fold =
        0.72F + 0.28F * std::sin(x * 6.2831853F * folds + 2.5F * TiledFbm(x, y, 3, 3, seed + 2));
    const float cloth = fold * (0.35F + 0.35F * y);
    const bool in_curtain = (dressing == kCurtains && (x < open || x > 1 - open)) ||
                            (dressing == kOneCurtain && x < 1.6F * open) ||
                            (dressing == kCafeCurtain && y < 0.5F);
    if (in_curtain) return cloth * curtain;
    if (dressing == kBlind && y > 1 - drop) {
      const float slat = y * 26 - std::floor(y * 26);
      return slat < 0.12F ? 0.3F * colour : (0.28F + 0.3F * slat) * curtain;
    }
    if (dressing == kRollerBlind && y > 1 - drop)
      return (y < 1.04F - drop ? 0.35F : 0.55F + 0.06F * TiledFbm(x, y, 8, 3, seed + 3)) * curtain;
    if (dressing == kNet)
      return Mix(colour, (0.3F + 0.3F * fold) * Rgba{0.8F, 0.79F, 0.75F, 1}, 0.6F);
    return colour;
  });
}

Texture PaintShop(uint32_t seed) {
  Random random(seed);
  const Rgba wall = RandomColour(random, 0.25F, 0.8F);
  const int shelves = 3 + random.Int(3);
  const int columns = 6 + random.Int(10);
  return Texture::Paint(256, [=](float x, float y) {
    Rgba colour = (0.3F + 0.35F * y) * wall;
    if (y > 0.86F) {
      const float strip = std::abs(x * 5 - std::floor(x * 5) - 0.5F);
      return strip < 0.3F ? Rgba{0.95F, 0.93F, 0.85F, 1} : 0.6F * wall;
    }
    const float shelf_y = y / 0.86F * static_cast<float>(shelves);
    const int shelf = static_cast<int>(shelf_y);
    const float in_shelf = shelf_y - static_cast<float>(shelf);
    const float column_x = x * static_cast<float>(columns) + 0.5F * LatticeValue(shelf, 1, seed);
    const int column = static_cast<int>(column_x);
    const float in_column = column_x - static_cast<float>(column);
    const float height = 0.3F + 0.6F * LatticeValue(column, shelf, seed + 1);
    if (in_shelf < 0.06F) return 0.25F * wall;
    if (in_shelf < height && in_column > 0.08F &&
        in_column < 0.55F + 0.4F * LatticeValue(column, shelf, seed + 2)) {
      colour = {0.1F + 0.7F * LatticeValue(column, shelf, seed + 3),
                0.1F + 0.6F * LatticeValue(column, shelf, seed + 4),
                0.1F + 0.5F * LatticeValue(column, shelf, seed + 5), 1};
      const int label = static_cast<int>(in_shelf * 8);
      if (LatticeValue(column * 8 + label, shelf, seed + 6) > 0.65F)
        colour = Mix(colour, {0.8F, 0.8F, 0.75F, 1}, 0.7F);
    }
    return (0.5F + 0.15F * TiledFbm(x, y, 4, 5, seed + 7)) * colour;
  });
}

Texture PaintDoor(uint32_t seed) {
  Random random(seed);
  static constexpr std::array<std::array<int, 3>, 9> kPaints = {{{92, 58, 36},
                                                                 {60, 38, 26},
                                                                 {126, 88, 54},
                                                                 {40, 62, 50},
                                                                 {34, 48, 74},
                                                                 {112, 30, 30},
                                                                 {52, 54, 58},
                                                                 {204, 200, 190},
                                                                 {70, 100, 112}}};
  const auto& c = kPaints[static_cast<size_t>(random.Int(9))];
  const Rgba paint = static_cast<float>(random.Uniform(0.7, 1.2)) * Srgb(c[0], c[1], c[2]);
  const bool glazed = random.Chance(0.5);
  const int rows = 2 + random.Int(3);
  return Texture::Paint(128, [=](float x, float y) {
    const float px = x * 2 - std::floor(x * 2);
    const float py = y * static_cast<float>(rows) - std::floor(y * static_cast<float>(rows));
    const float edge = std::min(std::min(px, 1 - px), std::min(py, 1 - py) * 1.5F);
    float value = 1 + 0.1F * TiledFbm(x, 0.125F * y, 24, 4, seed);
    value *= edge < 0.1F ? 1.0F : (edge < 0.16F ? 0.55F : 0.85F);
    if (glazed && y > 0.5F && edge > 0.16F) return Rgba{0.05F, 0.06F, 0.07F, 1};
    if (std::hypot(x - 0.9F, 1.5F * (y - 0.46F)) < 0.035F) return Rgba{0.6F, 0.52F, 0.3F, 1};
    return value * paint;
  });
}

Texture PaintLouvres(uint32_t seed) {
  return Texture::Paint(128, [seed](float x, float y) {
    const float half = y < 0.5F ? 2 * y : 2 * y - 1;  // two panels
    const bool rail = x < 0.12F || x > 0.88F || half < 0.08F || half > 0.94F;
    const float slat = half * 18 - std::floor(half * 18);
    const float wear = 1 + 0.08F * TiledFbm(x, y, 12, 4, seed, 0.7F);
    const float value = wear * (rail ? 0.8F : 0.3F + 0.5F * slat);
    return Rgba{value, value, value, 1};
  });
}

Texture PaintRollerShutter(uint32_t seed) {
  Random random(seed);
  const Rgba metal = static_cast<float>(random.Uniform(0.2, 0.45)) * Rgba{1, 1, 0.97F, 1};
  const Rgba spray = RandomColour(random, 0.05F, 0.7F);
  const Rgba outline =
      random.Chance(0.5) ? Rgba{0.02F, 0.02F, 0.02F, 1} : Rgba{0.8F, 0.8F, 0.8F, 1};
  const bool sprayed = random.Chance(0.75);
  return Texture::Paint(256, [=](float x, float y) {
    const float slat = y * 40 - std::floor(y * 40);
    Rgba colour = metal;
    if (sprayed && y < 0.75F) {
      // Large letters are approximated by bands between the level lines of a noise.
      const float shape =
          TiledFbm(x, 0.6F * y, 5, 2, seed + 1) - 2.2F * std::abs(y - 0.36F) + 0.35F;
      if (shape > 0.12F) colour = Mix(spray, {0.7F, 0.7F, 0.65F, 1}, 0.6F * y);
      if (std::abs(shape - 0.1F) < 0.05F) colour = outline;
    }
    const float rust = SmoothStep(0.2F, 0.9F, TiledFbm(x, 0.5F * y, 6, 5, seed + 2));
    return (0.55F + 0.5F * std::sin(3.14159265F * slat)) *
           Mix(colour, Srgb(110, 70, 46), 0.35F * rust * (1 - y));
  });
}

Texture PaintRailing(uint32_t seed) {
  return Texture::Paint(128, [seed](float x, float y) {
    const float bar = std::abs(x * 8 - std::floor(x * 8) - 0.5F);
    const bool solid =
        bar < 0.09F || y > 0.94F || (y > 0.06F && y < 0.11F) || (y > 0.8F && y < 0.84F);
    const float value = 0.04F * (1 + 0.3F * TiledFbm(x, y, 8, 4, seed));
    return Rgba{value, value, value, solid ? 1.0F : 0.0F};
  });
}

}  // namespace orb360::town
