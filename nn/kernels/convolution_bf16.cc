#include "nn/kernels/convolution_bf16.h"

#include <cstddef>
#include <vector>

#include "nn/base/bfloat16.h"

namespace orb360::nn {

namespace {

AlignedVector<std::uint16_t> Round(AlignedVector<float>& values) {
  AlignedVector<std::uint16_t> rounded(values.size());
  const Shape shape{1, 1, static_cast<int>(values.size())};
  Reorder(TensorFormat{shape, Layout::kPlanar, DataType::kFloat, 0}.View(values.data()),
          TensorFormat{shape, Layout::kPlanar, DataType::kBFloat16, 0}.View(rounded.data()));
  return rounded;
}

// Images are smooth, so the sum of a filter matters more than each of its weights. Each weight
// therefore absorbs the rounding remainder of the previous one, and errors do not add up where the
// input is constant over the window.
std::vector<float> RoundKeepingSums(std::span<const float> weight, int taps) {
  std::vector<float> rounded(weight.size());
  float left = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (i % taps == 0) left = 0;
    const float wanted = weight[i] + left;
    rounded[i] = ToFloat(ToBFloat16(wanted));
    left = wanted - rounded[i];
  }
  return rounded;
}

struct Filters {
  std::span<const float> weight;  // out_channels x in_channels x taps
  int out_channels;
  int in_channels;
  int taps;
};

// Appends the weights of half a group and of `count` input channels, in pairs, with zeros for
// channels that do not exist.
void AppendPairs(const Filters& filters, int first_out, int first_in, int count, int tap,
                 AlignedVector<float>* packed) {
  for (int i = first_in; i < first_in + count; i += 2) {
    for (int o = first_out; o < first_out + kBFloat16Half; ++o) {
      for (const int in : {i, i + 1}) {
        const bool exists = o < filters.out_channels && in < filters.in_channels;
        const std::size_t filter = static_cast<std::size_t>(o) * filters.in_channels + in;
        packed->push_back(exists ? filters.weight[filter * filters.taps + tap] : 0);
      }
    }
  }
}

}  // namespace

AlignedVector<std::uint16_t> PackBFloat16(std::span<const float> weight, int out_channels,
                                          int in_channels, int kernel) {
  const int taps = kernel * kernel;
  const std::vector<float> rounded = RoundKeepingSums(weight, taps);
  const Filters filters{rounded, out_channels, in_channels, taps};
  constexpr int kBlock = BlockOf(DataType::kBFloat16);
  AlignedVector<float> packed;
  for (int group = 0; group * kBFloat16Group < out_channels; ++group) {
    for (int first_in = 0; first_in < in_channels; first_in += kBlock) {
      for (int tap = 0; tap < filters.taps; ++tap) {
        for (int half = 0; half < HalvesInGroup(group, out_channels); ++half) {
          AppendPairs(filters, group * kBFloat16Group + half * kBFloat16Half, first_in, kBlock, tap,
                      &packed);
        }
      }
    }
  }
  return Round(packed);
}

}  // namespace orb360::nn
