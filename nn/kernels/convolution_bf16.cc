#include "nn/kernels/convolution_bf16.h"

#include <algorithm>
#include <cstddef>

namespace orb360::nn {

AlignedVector<std::uint16_t> PackBFloat16(std::span<const float> weight, int out_channels,
                                          int in_channels, int kernel) {
  const int taps = kernel * kernel;
  constexpr int kBlock = BlockOf(DataType::kBFloat16);
  AlignedVector<float> packed;
  for (int group = 0; group * kBFloat16Group < out_channels; ++group) {
    for (int block = 0; block * kBlock < in_channels; ++block) {
      for (int tap = 0; tap < taps; ++tap) {
        for (int half = 0; half < HalvesInGroup(group, out_channels); ++half) {
          for (int i = block * kBlock; i < (block + 1) * kBlock; i += 2) {
            const int first = group * kBFloat16Group + half * kBFloat16Half;
            for (int o = first; o < first + kBFloat16Half; ++o) {
              for (const int in : {i, i + 1}) {
                const bool exists = o < out_channels && in < in_channels;
                packed.push_back(
                    exists ? weight[(static_cast<std::size_t>(o) * in_channels + in) * taps + tap]
                           : 0);
              }
            }
          }
        }
      }
    }
  }
  AlignedVector<std::uint16_t> rounded(packed.size());
  const Shape shape{1, 1, static_cast<int>(packed.size())};
  Reorder(TensorFormat{shape, Layout::kPlanar, DataType::kFloat, 0}.View(packed.data()),
          TensorFormat{shape, Layout::kPlanar, DataType::kBFloat16, 0}.View(rounded.data()));
  return rounded;
}

}  // namespace orb360::nn
