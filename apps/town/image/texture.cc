#include "apps/town/image/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

uint32_t Encode(const Rgba& c) {
  const auto channel = [](float x) {
    return static_cast<uint32_t>(std::clamp(x, 0.0F, 1.0F) * 255 + 0.5F);
  };
  return channel(std::sqrt(std::max(c.r, 0.0F))) | channel(std::sqrt(std::max(c.g, 0.0F))) << 8 |
         channel(std::sqrt(std::max(c.b, 0.0F))) << 16 | channel(c.a) << 24;
}

/// Halves the size by 2x2 means. Colours are weighted by coverage, so that colours outside a
/// cut-out do not bleed into it.
std::vector<Rgba> Halve(const std::vector<Rgba>& source, int width, int height) {
  const int half_width = std::max(width / 2, 1);
  const int half_height = std::max(height / 2, 1);
  std::vector<Rgba> result(static_cast<size_t>(half_width) * static_cast<size_t>(half_height));
  for (int y = 0; y < half_height; ++y) {
    for (int x = 0; x < half_width; ++x) {
      Rgba sum{0, 0, 0, 0};
      float weight = 0;
      for (int k = 0; k < 4; ++k) {
        const int sx = std::min(2 * x + (k & 1), width - 1);
        const int sy = std::min(2 * y + (k >> 1), height - 1);
        const Rgba& c =
            source[static_cast<size_t>(sy) * static_cast<size_t>(width) + static_cast<size_t>(sx)];
        const float w = c.a + 1e-3F;
        sum = {sum.r + w * c.r, sum.g + w * c.g, sum.b + w * c.b, sum.a + 0.25F * c.a};
        weight += w;
      }
      result[static_cast<size_t>(y) * static_cast<size_t>(half_width) + static_cast<size_t>(x)] = {
          sum.r / weight, sum.g / weight, sum.b / weight, sum.a};
    }
  }
  return result;
}

}  // namespace

Rgba Srgb(int r, int g, int b) {
  const auto decode = [](int value) {
    const double x = value / 255.0;
    return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
  };
  return {decode(r), decode(g), decode(b), 1};
}

Texture Texture::Paint(int size, const std::function<Rgba(float, float)>& paint) {
  std::vector<Rgba> texels(static_cast<size_t>(size) * static_cast<size_t>(size));
#pragma omp parallel for schedule(dynamic, 8)
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      texels[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)] =
          paint((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                (static_cast<float>(y) + 0.5F) / static_cast<float>(size));
    }
  }
  return Texture(size, size, std::move(texels));
}

Texture::Texture(int width, int height, std::vector<Rgba> texels)
    : mean_side_(std::sqrt(static_cast<float>(width) * static_cast<float>(height))) {
  ORB360_CHECK(std::has_single_bit(static_cast<unsigned>(width)) &&
                   std::has_single_bit(static_cast<unsigned>(height)) &&
                   texels.size() == static_cast<size_t>(width) * static_cast<size_t>(height),
               width, height, texels.size());
  ORB360_CHECK(std::all_of(texels.begin(), texels.end(),
                           [](const Rgba& c) { return std::isfinite(c.r + c.g + c.b + c.a); }));
  covered_.resize(texels.size() / 64 + 1);
  for (size_t i = 0; i < texels.size(); ++i) {
    if (texels[i].a >= 0.5F) covered_[i / 64] |= 1ULL << (i % 64);
  }
  while (true) {
    levels_.push_back({width, height, texels_.size()});
    for (int y = 0; y <= height; ++y) {
      const size_t row = static_cast<size_t>(y % height) * static_cast<size_t>(width);
      for (int x = 0; x <= width; ++x)
        texels_.push_back(Encode(texels[row + static_cast<size_t>(x % width)]));
    }
    if (width == 1 && height == 1) break;
    texels = Halve(texels, width, height);
    width = std::max(width / 2, 1);
    height = std::max(height / 2, 1);
  }
}

Rgba Texture::Sample(float u, float v, float level) const {
  const Level& l = LevelAt(level);
  const float x = u * static_cast<float>(l.width) - 0.5F;  // texel centres are at halves
  const float y = v * static_cast<float>(l.height) - 0.5F;
  const float wx = x - std::floor(x);
  const float wy = y - std::floor(y);
  const size_t stride = static_cast<size_t>(l.width) + 1;
  const uint32_t* below = TexelsOf(l) +
                          static_cast<size_t>(FloorToInt(y) & (l.height - 1)) * stride +
                          static_cast<size_t>(FloorToInt(x) & (l.width - 1));
  const uint32_t* above = below + stride;
  const auto root = [&](int shift) {
    const auto channel = [&](uint32_t texel) { return static_cast<float>(texel >> shift & 255U); };
    return ((1 - wy) * ((1 - wx) * channel(below[0]) + wx * channel(below[1])) +
            wy * ((1 - wx) * channel(above[0]) + wx * channel(above[1]))) /
           255;
  };
  return {root(0) * root(0), root(8) * root(8), root(16) * root(16), root(24)};
}

}  // namespace orb360::town
