#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// One run of a 3x3 convolution of stride 1 by Winograd's minimal filtering F(4x4, 3x3). Every tile
/// of 4x4 outputs takes 36 products for each pair of channels in place of 144. Input tiles of 6x6,
/// filters and outputs are transformed (Lavin and Gray, "Fast Algorithms for Convolutional Neural
/// Networks", 2016).
struct WinogradConvolution {
  float slope = 1;
  const std::vector<int>* groups = nullptr;  // as for the direct kernel
  const float* weight = nullptr;             // by PackWinograd
  const float* bias = nullptr;               // of every output channel of every group
  TensorView input;                          // floats, kBlocked, with their padding in the halo
  TensorView residual;                       // data is null if there is none
  TensorView output;                         // floats
};

/// Transforms the filters, out_channels x in_channels x 3 x 3, to [group][product of 36][input
/// channel][output channel].
AlignedVector<float> PackWinograd(std::span<const float> weight, int out_channels, int in_channels,
                                  const std::vector<int>& groups);

/// Number of outputs of a tile in a row.
constexpr int kWinogradTile = 4;

/// Products of a tile over those of its definition.
constexpr double kWinogradProductFraction = 36.0 / 144;

/// Returns the number of tiles that cover the output; they are counted row by row.
int CountWinogradTiles(const Shape& output);

/// Largest number of tiles that RunWinograd takes at once: two register tiles of 14; it may be at
/// most 32.
constexpr int kMaxWinogradTiles = 28;

/// Bytes of scratch memory that RunWinograd needs.
std::size_t WinogradScratchBytes(int in_channels);

/// Computes tiles `first` to `last` - 1. `scratch` is aligned to kAlignment. Tiles whose input
/// contains NaN or infinity, which would spread over the whole tile, are not computed: bit i of the
/// result is set if tile first + i is one of them.
std::uint32_t RunWinograd(const WinogradConvolution& run, int first, int last, std::byte* scratch);

/// Only the products of RunWinograd for `count` tiles, from whatever is in `scratch` and to there.
/// For benchmarks.
void RunWinogradProducts(const WinogradConvolution& run, int count, std::byte* scratch);

}  // namespace orb360::nn
