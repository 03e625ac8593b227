#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// A linear (not gamma-encoded) colour; `a` is coverage for cut-outs.
struct Rgba {
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 1;
};

inline Rgba Mix(const Rgba& x, const Rgba& y, float t) {
  return {x.r + (y.r - x.r) * t, x.g + (y.g - x.g) * t, x.b + (y.b - x.b) * t,
          x.a + (y.a - x.a) * t};
}
inline Rgba operator*(float s, const Rgba& c) { return {s * c.r, s * c.g, s * c.b, c.a}; }

/// Colour from 8-bit sRGB values, as a colour picker shows them.
Rgba Srgb(int r, int g, int b);

/// A tiling image with its mip chain. Texels hold the square root of the linear value in 8 bits
/// (close to sRGB, and decoded by one multiplication). Sides are powers of two.
class Texture {
 public:
  /// Fills a size x size image by calling `paint(x, y)` at the texel centres, x and y in [0, 1),
  /// y running up.
  static Texture Paint(int size, const std::function<Rgba(float x, float y)>& paint);
  /// From row-major linear texels, the first row at the bottom (v = 0).
  Texture(int width, int height, std::vector<Rgba> texels);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  /// Texels along the side of a square of as many.
  float mean_side() const { return mean_side_; }
  size_t bytes() const { return texels_.size() * sizeof(uint32_t); }

  /// Bilinear sample of one mip level; (u, v) in tiles, wrapping. `level` is the base-2 logarithm
  /// of the footprint in texels, and is rounded down: a caller that takes several samples a pixel
  /// gets trilinear filtering by adding evenly spread offsets in [0, 1) to it.
  Rgba Sample(float u, float v, float level) const {
    const int count = static_cast<int>(levels_.size());
    const int index =
        level <= 0 ? 0 : (level < static_cast<float>(count) ? static_cast<int>(level) : count - 1);
    const Level& l = levels_[static_cast<size_t>(index)];
    // Coordinates with 8 fractional bits; texel centres are at halves.
    const int x = FloorToInt(u * static_cast<float>(l.width * 256)) - 128;
    const int y = FloorToInt(v * static_cast<float>(l.height * 256)) - 128;
    const auto wx = static_cast<uint32_t>(x & 255);
    const auto wy = static_cast<uint32_t>(y & 255);
    const int x0 = (x >> 8) & (l.width - 1);
    const int x1 = (x0 + 1) & (l.width - 1);
    const int y0 = (y >> 8) & (l.height - 1);
    const int y1 = (y0 + 1) & (l.height - 1);
    const uint32_t* texels = texels_.data() + l.offset;
    const uint32_t* row0 = texels + static_cast<size_t>(y0) * static_cast<size_t>(l.width);
    const uint32_t* row1 = texels + static_cast<size_t>(y1) * static_cast<size_t>(l.width);
    const uint32_t w11 = wx * wy >> 8;  // the four weights add up to 256
    return Decode((256 - wx - wy + w11) * Spread(row0[x0]) + (wx - w11) * Spread(row0[x1]) +
                  (wy - w11) * Spread(row1[x0]) + w11 * Spread(row1[x1]));
  }

  /// Whether the nearest texel of level 0 covers at least half.
  bool Covers(float u, float v) const {
    const Level& l = levels_.front();
    const auto x = static_cast<size_t>(FloorToInt(u * static_cast<float>(l.width)) & (l.width - 1));
    const auto y =
        static_cast<size_t>(FloorToInt(v * static_cast<float>(l.height)) & (l.height - 1));
    const size_t texel = y * static_cast<size_t>(l.width) + x;
    return (covered_[texel / 64] >> (texel % 64) & 1U) != 0;
  }

 private:
  struct Level {
    int width;
    int height;
    size_t offset;
  };

  static int FloorToInt(float x) {
    const int truncated = static_cast<int>(x);
    return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
  }
  /// The four channels of a texel, red, blue, green and coverage, in 16 bits each.
  static uint64_t Spread(uint32_t texel) {
    return (texel & 0x00ff00ffU) | static_cast<uint64_t>(texel & 0xff00ff00U) << 24;
  }
  /// From a sum of spread texels with weights that add up to 256.
  static Rgba Decode(uint64_t sum) {
    const auto channels = std::bit_cast<std::array<uint16_t, 4>>(sum);
    std::array<float, 4> roots;
    for (size_t i = 0; i < 4; ++i)
      roots[i] = static_cast<float>(channels[i]) * (1.0F / (255 * 256));
    return {roots[0] * roots[0], roots[2] * roots[2], roots[1] * roots[1], roots[3]};
  }

  float mean_side_ = 1;
  std::vector<Level> levels_;
  std::vector<uint32_t> texels_;
  std::vector<uint64_t> covered_;  ///< one bit a texel of level 0
};

/// log2(x) for positive x, within 0.09: enough to choose a mip level.
inline float FastLog2(float x) {
  const auto bits = std::bit_cast<uint32_t>(x);
  return static_cast<float>(bits) * 0x1p-23F - 127.0F;
}

}  // namespace orb360::town
