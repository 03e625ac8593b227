#include <algorithm>

#include "nn/kernels/convolution_winograd.h"
#include "nn/kernels/winograd_points.h"

namespace orb360::nn {

namespace {

// Powers 0, 1, 2 of the points, over the product of their differences from the other points.
constexpr double kStride1[kFilters][3] = {{1, 0, 0},
                                          {-1 / 1.5, -kA / 1.5, -0.5 / 1.5},
                                          {-1 / 1.5, kA / 1.5, -0.5 / 1.5},
                                          {1 / 6.0, kB / 6, 2 / 6.0},
                                          {1 / 6.0, -kB / 6, 2 / 6.0},
                                          {0, 0, 1}};
// Likewise powers 0 and 1, of the two outer taps; that of the centre stays as it is.
constexpr double kStride2[kFilters][3] = {{1, 0, 0},
                                          {-1 / 1.125, 0, -0.5 / 1.125},
                                          {-1 / 4.5, 0, 1 / 4.5},
                                          {1 / 9.0, 0, 2 / 9.0},
                                          {0, 0, 1},
                                          {0, 1, 0}};

}  // namespace

AlignedVector<float> PackWinograd(std::span<const float> weight, int out_channels, int in_channels,
                                  int stride, const std::vector<int>& groups) {
  constexpr int kBlock = BlockOf(DataType::kFloat);
  const auto& transform = stride == 1 ? kStride1 : kStride2;
  constexpr int kAll = kFilters * kFilters;
  int blocks_before = 0;
  std::size_t size = 0;
  for (const int blocks : groups) size += static_cast<std::size_t>(blocks) * kBlock;
  AlignedVector<float> packed(size * kAll * in_channels);
  float* group = packed.data();
  for (const int blocks : groups) {
    const int width = blocks * kBlock;
    // The transformed filters of one input channel. They are gathered first, because rows of the
    // whole array are too far apart for a cache.
    std::vector<float> filters(static_cast<std::size_t>(kAll) * width);
    for (int i = 0; i < in_channels; ++i) {
      for (int o = 0; o < width && blocks_before * kBlock + o < out_channels; ++o) {
        const float* taps =
            weight.data() +
            (static_cast<std::size_t>(blocks_before * kBlock + o) * in_channels + i) * 9;
        double rows[kFilters][3];
        for (int p = 0; p < kFilters; ++p) {
          for (int u = 0; u < 3; ++u) {
            rows[p][u] = transform[p][0] * taps[u] + transform[p][1] * taps[3 + u] +
                         transform[p][2] * taps[6 + u];
          }
        }
        for (int f = 0; f < kAll; ++f) {
          const double* row = rows[f / kFilters];
          const double* column = transform[f % kFilters];
          filters[f * width + o] =
              static_cast<float>(row[0] * column[0] + row[1] * column[1] + row[2] * column[2]);
        }
      }
      for (int f = 0; f < kAll; ++f) {
        std::copy_n(filters.data() + f * width, width,
                    group + (static_cast<std::ptrdiff_t>(f) * in_channels + i) * width);
      }
    }
    group += static_cast<std::ptrdiff_t>(kAll) * in_channels * width;
    blocks_before += blocks;
  }
  return packed;
}

}  // namespace orb360::nn
