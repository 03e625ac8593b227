#pragma once

#include <algorithm>
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

/// Returns the colour of 8-bit sRGB values, as a colour picker shows them.
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
  /// The side, in texels, of a square with as many texels.
  float mean_side() const { return mean_side_; }
  size_t bytes() const { return texels_.size() * sizeof(uint32_t); }

  /// A mip level: row-major texels. The first row and column are repeated behind the last ones, so
  /// that the four texels around any position are adjacent.
  struct Level {
    int width;
    int height;
    size_t offset;
  };
  /// Returns the level for a footprint of 2^`level` texels, rounded down.
  const Level& LevelAt(float level) const {
    const int last = static_cast<int>(levels_.size()) - 1;
    const float clamped = std::min(std::max(0.0F, level), static_cast<float>(last));
    return levels_[static_cast<size_t>(clamped)];
  }
  /// Returns its texels: red, green, blue and coverage from the lowest byte upward. Colours are
  /// square roots of linear values.
  const uint32_t* TexelsOf(const Level& level) const { return texels_.data() + level.offset; }

  /// Returns a bilinear sample of one mip level; (u, v) are in tiles and wrap. `level` is the
  /// base-2 logarithm of the footprint in texels and is rounded down. A caller that takes several
  /// samples per pixel gets trilinear filtering by adding evenly distributed offsets in [0, 1) to
  /// it.
  Rgba Sample(float u, float v, float level) const;

  /// Returns true if the nearest texel of level 0 has a coverage of at least a half.
  bool Covers(float u, float v) const {
    const Level& l = levels_.front();
    const auto x = static_cast<size_t>(FloorToInt(u * static_cast<float>(l.width)) & (l.width - 1));
    const auto y =
        static_cast<size_t>(FloorToInt(v * static_cast<float>(l.height)) & (l.height - 1));
    const size_t texel = y * static_cast<size_t>(l.width) + x;
    return (covered_[texel / 64] >> (texel % 64) & 1U) != 0;
  }

 private:
  static int FloorToInt(float x) {
    const int truncated = static_cast<int>(x);
    return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
  }

  float mean_side_ = 1;
  std::vector<Level> levels_;
  std::vector<uint32_t> texels_;
  std::vector<uint64_t> covered_;  ///< one bit a texel of level 0
};

}  // namespace orb360::town
