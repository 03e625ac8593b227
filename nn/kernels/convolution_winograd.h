#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// One run of a 3x3 convolution by Winograd's minimal filtering (Lavin and Gray, "Fast Algorithms
/// for Convolutional Neural Networks", 2016). Every tile of 4x4 outputs takes 36 products for each
/// pair of channels in place of 144, F(4x4, 3x3), or 81 with a stride of 2, where the polyphase
/// components of the filter have 2x2, 2x1, 1x2 and 1x1 taps: F(4, 2) in the directions of two taps.
/// Input tiles of 6x6 or 9x9, filters and outputs are transformed.
struct WinogradConvolution {
  int stride = 1;  // or 2
  float slope = 1;
  const std::vector<int>* groups = nullptr;  // as for the direct kernel
  const float* weight = nullptr;             // by PackWinograd
  const float* bias = nullptr;               // of every output channel of every group
  TensorView input;                          // floats, kBlocked, with their padding in the halo
  TensorView residual;                       // data is null if there is none
  TensorView output;                         // floats
};

/// Transforms the filters, out_channels x in_channels x 3 x 3, to [group][36 of them][input
/// channel][output channel].
AlignedVector<float> PackWinograd(std::span<const float> weight, int out_channels, int in_channels,
                                  int stride, const std::vector<int>& groups);

/// Number of outputs of a tile in a row.
constexpr int kWinogradTile = 4;

/// Products of a tile for each pair of channels; the definition has 144.
constexpr int WinogradProducts(int stride) { return stride == 1 ? 36 : 81; }

/// Returns the number of tiles that cover the output; they are counted row by row.
int CountWinogradTiles(const Shape& output);

/// Largest number of tiles that RunWinograd takes at once, at most 32: whole register tiles, 2 x 14
/// with AVX-512, and 12 or 2 x 6 with a stride of 2, where a tile has more products. What they take
/// is about as large as a second-level cache.
constexpr int MaxWinogradTiles(int stride) { return stride == 1 ? 28 : 12; }

/// Bytes of scratch memory that RunWinograd needs.
std::size_t WinogradScratchBytes(int in_channels, int stride);

/// Computes tiles `first` to `last` - 1. `scratch` is aligned to kAlignment. Tiles whose input
/// contains NaN or infinity, which would spread over the whole tile, are not computed: bit i of the
/// result is set if tile first + i is one of them.
std::uint32_t RunWinograd(const WinogradConvolution& run, int first, int last, std::byte* scratch);

/// Only the products of RunWinograd for `count` tiles, from whatever is in `scratch` and to there.
/// For benchmarks.
void RunWinogradProducts(const WinogradConvolution& run, int count, std::byte* scratch);

}  // namespace orb360::nn
