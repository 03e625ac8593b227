#pragma once

#include <cstdint>
#include <span>

#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// One run of a convolution of bfloat16 numbers, summed as floats.
struct BFloat16Convolution {
  int kernel = 1;
  int stride = 1;
  float slope = 1;
  const std::uint16_t* weight = nullptr;  // by PackBFloat16
  const float* bias = nullptr;            // of all channels of all blocks of the output
  TensorView input;                       // with its padding in its halo
  TensorView residual;                    // data is null if there is none
  TensorView output;                      // kBFloat16 blocks, or kFloat in any layout
};

/// Number of output channels that are computed together: a block of bfloat16, or two columns of
/// tiles.
constexpr int kBFloat16Group = BlockOf(DataType::kBFloat16);

/// Half of a group: the columns of a tile, the lanes of a vector of floats.
constexpr int kBFloat16Half = kBFloat16Group / 2;

/// Returns the number of columns of tiles in group `group`.
constexpr int HalvesInGroup(int group, int out_channels) {
  return out_channels - group * kBFloat16Group > kBFloat16Half ? 2 : 1;
}

/// Rounds the weights, out_channels x in_channels x kernel x kernel, so that every filter keeps the
/// sum of its weights up to one rounding, and orders them as the units read them: [group][input
/// block][kernel row][kernel column][half][pair of input channels] [output channel][channel of the
/// pair], where the last three dimensions are one tile of 1 KiB.
AlignedVector<std::uint16_t> PackBFloat16(std::span<const float> weight, int out_channels,
                                          int in_channels, int kernel);

/// Computes rows `first` to `last` - 1 of the output with AMX or AVX-512's VDPBF16PS, which the
/// processor must have.
void RunAmx(const BFloat16Convolution& run, int first, int last);
void RunAvx512BFloat16(const BFloat16Convolution& run, int first, int last);

}  // namespace orb360::nn
