#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/nn/tensor_memory.h"
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Channels x rows x columns in double precision, without layout or halo: what kernels are compared
/// with.
struct PlainImage {
  explicit PlainImage(const Shape& size)
      : shape(size), values(static_cast<std::size_t>(size.channels) * size.height * size.width) {}

  double& at(int channel, int y, int x) {
    return values[(static_cast<std::size_t>(channel) * shape.height + y) * shape.width + x];
  }
  double at(int channel, int y, int x) const {
    return const_cast<PlainImage&>(*this).at(channel, y, x);
  }

  /// What stands at a place that may lie beyond the edge, found by walking over the sphere.
  double padded(Padding padding, int channel, int y, int x) const {
    if (padding == Padding::kZero) {
      const bool inside = y >= 0 && y < shape.height && x >= 0 && x < shape.width;
      return inside ? at(channel, y, x) : 0;
    }
    if (padding == Padding::kWrapReplicate) {
      y = std::min(std::max(y, 0), shape.height - 1);
    } else {
      while (y < 0 || y >= shape.height) {
        y = y < 0 ? -1 - y : 2 * shape.height - 1 - y;
        x += shape.width / 2;
      }
    }
    return at(channel, y, (x % shape.width + shape.width) % shape.width);
  }

  Shape shape;
  std::vector<double> values;
};

/// Floats, evenly distributed.
inline PlainImage RandomImage(const Shape& shape, float lowest, float highest, unsigned seed) {
  PlainImage image(shape);
  std::mt19937 random(seed);
  for (double& value : image.values) {
    const float fraction = static_cast<float>(random() >> 8) * 0x1p-24f;
    value = lowest + (highest - lowest) * fraction;
    value = static_cast<float>(value);
  }
  return image;
}

inline std::vector<float> RandomFloats(std::size_t count, float lowest, float highest,
                                       unsigned seed) {
  const PlainImage image = RandomImage({1, 1, static_cast<int>(count)}, lowest, highest, seed);
  return {image.values.begin(), image.values.end()};
}

/// A float tensor that holds `image`; the channels that fill up a block are zero, the halo is
/// what TensorMemory begins with.
class FilledTensor : public TensorMemory {
 public:
  FilledTensor(const PlainImage& image, Layout layout, int halo)
      : TensorMemory({image.shape, layout, DataType::kFloat, halo}) {
    const auto [channels, rows, columns] = image.shape;
    const int block = layout == Layout::kBlocked ? BlockOf(DataType::kFloat) : 1;
    for (int c = 0; c < view.planes() * block; ++c) {
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
          At(view, c, y, x) = c < channels ? static_cast<float>(image.at(c, y, x)) : 0.0f;
        }
      }
    }
  }
};

/// Memory that a kernel may use while it runs, every byte 0xff at first: NaN, which would spread.
struct Scratch {
  explicit Scratch(std::size_t size) : memory(size + kAlignment, std::byte{0xff}) {
    void* start = memory.data();
    std::size_t room = memory.size();
    bytes = {static_cast<std::byte*>(std::align(kAlignment, size, start, room)), size};
  }
  std::vector<std::byte> memory;
  std::span<std::byte> bytes;
};

/// Every value is within `tolerance` of what is expected, NaN where NaN is expected; the worst
/// element is reported. What fills up the last block must be zero.
inline void ExpectNear(const TensorView& actual, const PlainImage& expected,
                       const PlainImage& tolerance) {
  ASSERT_EQ(actual.shape, expected.shape);
  double worst = -1;
  int where[3] = {};
  const auto [channels, rows, columns] = expected.shape;
  for (int c = 0; c < channels; ++c) {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const double is = At(actual, c, y, x);
        const double should = expected.at(c, y, x);
        const bool same = is == should || (std::isnan(is) && std::isnan(should));
        const double allowed = tolerance.at(c, y, x);
        double excess = same ? 0 : std::abs(is - should) / allowed;
        if (!(excess >= 0)) excess = HUGE_VAL;  // NaN on one side only
        if (excess > worst) {
          worst = excess;
          where[0] = c;
          where[1] = y;
          where[2] = x;
        }
      }
    }
  }
  EXPECT_LE(worst, 1) << "worst at channel " << where[0] << " y " << where[1] << " x " << where[2]
                      << ": " << At(actual, where[0], where[1], where[2]) << " instead of "
                      << expected.at(where[0], where[1], where[2]) << ", allowed "
                      << tolerance.at(where[0], where[1], where[2]);
  if (actual.layout != Layout::kBlocked) return;
  for (int c = channels; c < actual.planes() * BlockOf(actual.type); ++c) {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        ASSERT_EQ(At(actual, c, y, x), 0)
            << "behind the last channel: " << c << ' ' << y << ' ' << x;
      }
    }
  }
}

inline void ExpectEqual(const TensorView& actual, const PlainImage& expected) {
  ExpectNear(actual, expected, PlainImage(expected.shape));
}

/// The bytes of all pixels are the same, those of the halos left out.
inline void ExpectSameBits(const TensorView& a, const TensorView& b) {
  ASSERT_EQ(a.shape, b.shape);
  for (int c = 0; c < a.shape.channels; ++c) {
    for (int y = 0; y < a.shape.height; ++y) {
      for (int x = 0; x < a.shape.width; ++x) {
        const float first = At(a, c, y, x);
        const float second = At(b, c, y, x);
        ASSERT_EQ(std::bit_cast<uint32_t>(first), std::bit_cast<uint32_t>(second))
            << "channel " << c << " y " << y << " x " << x << ": " << first << " and " << second;
      }
    }
  }
}

}  // namespace orb360::nn
