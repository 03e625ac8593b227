#include <algorithm>

#include "nn/kernels/convolution_winograd.h"
#include "nn/kernels/winograd_points.h"

namespace orb360::nn {

AlignedVector<float> PackWinograd(std::span<const float> weight, int out_channels, int in_channels,
                                  const std::vector<int>& groups) {
  constexpr int kBlock = BlockOf(DataType::kFloat);
  // Powers 0, 1, 2 of the points, over the product of their differences from the other points.
  const double transform[kIn][3] = {{1, 0, 0},
                                    {-1 / 1.5, -kA / 1.5, -0.5 / 1.5},
                                    {-1 / 1.5, kA / 1.5, -0.5 / 1.5},
                                    {1 / 6.0, kB / 6, 2 / 6.0},
                                    {1 / 6.0, -kB / 6, 2 / 6.0},
                                    {0, 0, 1}};
  int blocks_before = 0;
  std::size_t size = 0;
  for (const int blocks : groups) size += static_cast<std::size_t>(blocks) * kBlock;
  AlignedVector<float> packed(size * kProducts * in_channels);
  float* group = packed.data();
  for (const int blocks : groups) {
    const int width = blocks * kBlock;
    // The products of one input channel. They are gathered first, because rows of the whole array
    // are too far apart for a cache.
    std::vector<float> products(static_cast<std::size_t>(kProducts) * width);
    for (int i = 0; i < in_channels; ++i) {
      for (int o = 0; o < width && blocks_before * kBlock + o < out_channels; ++o) {
        const float* filter =
            weight.data() +
            (static_cast<std::size_t>(blocks_before * kBlock + o) * in_channels + i) * 9;
        double rows[kIn][3];
        for (int p = 0; p < kIn; ++p) {
          for (int u = 0; u < 3; ++u) {
            rows[p][u] = transform[p][0] * filter[u] + transform[p][1] * filter[3 + u] +
                         transform[p][2] * filter[6 + u];
          }
        }
        for (int product = 0; product < kProducts; ++product) {
          const double* row = rows[product / kIn];
          const double* column = transform[product % kIn];
          products[product * width + o] =
              static_cast<float>(row[0] * column[0] + row[1] * column[1] + row[2] * column[2]);
        }
      }
      for (int product = 0; product < kProducts; ++product) {
        std::copy_n(products.data() + product * width, width,
                    group + (static_cast<std::ptrdiff_t>(product) * in_channels + i) * width);
      }
    }
    group += static_cast<std::ptrdiff_t>(kProducts) * in_channels * width;
    blocks_before += blocks;
  }
  return packed;
}

}  // namespace orb360::nn
