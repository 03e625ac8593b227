#include "nn/models/resample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

std::size_t PixelsOf(ImageSize size) {
  return static_cast<std::size_t>(size.height) * static_cast<std::size_t>(size.width);
}

/// The two samples, among `count`, between which a position lies, and its distance from the first
/// one.
struct Between {
  int first;
  int second;
  float fraction;
};

Between Locate(int index, int to_count, int from_count, bool wraps) {
  const double position =
      (index + 0.5) * static_cast<double>(from_count) / static_cast<double>(to_count) - 0.5;
  const auto below = static_cast<int>(std::floor(position));
  const auto fraction = static_cast<float>(position - below);
  if (wraps) return {(below + from_count) % from_count, (below + 1) % from_count, fraction};
  return {std::max(below, 0), std::min(below + 1, from_count - 1), fraction};
}

}  // namespace

void ResampleBilinear(std::span<const float> from, ImageSize from_size, std::span<float> to,
                      ImageSize to_size) {
  ORB360_CHECK(from.size() == PixelsOf(from_size) && to.size() == PixelsOf(to_size), from.size(),
               to.size());
  std::vector<Between> columns;
  columns.reserve(static_cast<std::size_t>(to_size.width));
  for (int u = 0; u < to_size.width; ++u) {
    columns.push_back(Locate(u, to_size.width, from_size.width, /*wraps=*/true));
  }
  float* next = to.data();
  for (int v = 0; v < to_size.height; ++v) {
    const Between rows = Locate(v, to_size.height, from_size.height, /*wraps=*/false);
    const float* top = from.data() + std::ptrdiff_t{rows.first} * from_size.width;
    const float* bottom = from.data() + std::ptrdiff_t{rows.second} * from_size.width;
    for (const Between& column : columns) {
      const auto across = [&](const float* row) {
        return row[column.first] + column.fraction * (row[column.second] - row[column.first]);
      };
      const float above = across(top);
      *next++ = above + rows.fraction * (across(bottom) - above);
    }
  }
}

void ResampleImage(std::vector<float> from, ImageSize from_size, std::span<float> to,
                   ImageSize to_size) {
  ORB360_CHECK(from.size() == PixelsOf(from_size), from.size());
  while (from_size.height >= 2 * to_size.height && from_size.width >= 2 * to_size.width) {
    const ImageSize half{from_size.height / 2, from_size.width / 2};
    float* next = from.data();
    for (int v = 0; v < half.height; ++v) {
      const float* top = from.data() + 2 * std::ptrdiff_t{v} * from_size.width;
      const float* bottom = top + from_size.width;
      for (int u = 0; u < half.width; ++u, top += 2, bottom += 2) {
        *next++ = ((top[0] + top[1]) + (bottom[0] + bottom[1])) / 4;
      }
    }
    from.resize(PixelsOf(half));
    from_size = half;
  }
  if (from_size == to_size) {
    std::ranges::copy(from, to.begin());
  } else {
    ResampleBilinear(from, from_size, to, to_size);
  }
}

void ResamplePoints(std::span<const float> depth, std::span<const float> confidence,
                    ImageSize from_size, std::span<float> to_depth, std::span<float> to_confidence,
                    ImageSize to_size) {
  ORB360_CHECK(depth.size() == PixelsOf(from_size) && confidence.size() == depth.size(),
               depth.size(), confidence.size());
  ORB360_CHECK(to_depth.size() == PixelsOf(to_size) && to_confidence.size() == to_depth.size(),
               to_depth.size(), to_confidence.size());
  std::ranges::fill(to_depth, 0.0f);
  std::ranges::fill(to_confidence, 0.0f);
  // The pixel that contains the centre of pixel i: floor((i + 1/2) * to / from), in integers.
  const auto moved = [](int i, int from_count, int to_count) {
    return static_cast<std::size_t>((2 * std::int64_t{i} + 1) * to_count / (2 * from_count));
  };
  std::size_t pixel = 0;
  for (int v = 0; v < from_size.height; ++v) {
    const std::size_t row = moved(v, from_size.height, to_size.height);
    for (int u = 0; u < from_size.width; ++u, ++pixel) {
      if (!(depth[pixel] > 0)) continue;
      const std::size_t target =
          row * static_cast<std::size_t>(to_size.width) + moved(u, from_size.width, to_size.width);
      if (to_depth[target] > 0 && to_depth[target] <= depth[pixel]) continue;
      to_depth[target] = depth[pixel];
      to_confidence[target] = confidence[pixel];
    }
  }
}

}  // namespace orb360::nn
