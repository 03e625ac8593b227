#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// How floats become bytes: q = clamp(round(x * steps) + zero, lowest, lowest + 255), to nearest,
/// ties to even. Zero is represented exactly, so padding with zeros stays exact. NaN becomes the
/// highest byte.
struct ByteScale {
  float steps = 1;          // per unit
  std::int32_t zero = 0;    // lowest to lowest + 255
  std::int32_t lowest = 0;  // of the bytes: 0, or -128 for a unit whose bytes have signs
};

/// Returns the scale for inputs from `minimum` to `maximum`; zero is always inside. Where all bytes
/// are lower by 128, `zero` is too, so that q - zero and with it every sum stays the same.
ByteScale ByteScaleOf(float minimum, float maximum, std::int32_t lowest = 0);

/// Number of output channels whose weights lie together, and half of it: the lanes of a vector of
/// AVX-512.
constexpr int kInt8Group = 32;
constexpr int kInt8Half = kInt8Group / 2;
/// Input channels whose products one lane adds up in one step.
constexpr int kInt8Quad = 4;
/// Input channels of a pixel that lie together: those of a block of floats.
constexpr int kInt8Block = BlockOf(DataType::kFloat);

/// Weights rounded to bytes and what the integer sums become with them.
struct Int8Weights {
  /// [group][input block][kernel row][kernel column][quad of input channels][half][output channel]
  /// [channel of the quad]; a last group of at most kInt8Half channels has one half.
  AlignedVector<std::int8_t> weight;
  /// The sum of every output channel's weights times -zero, from which its sum starts.
  AlignedVector<std::int32_t> first_sum;
  /// What one unit of an output channel's sum is worth.
  AlignedVector<float> scale;
};

/// Rounds the weights, out_channels x in_channels x kernel x kernel. Every output channel has a
/// scale of its own, for which its largest weight becomes 127. Every filter of one input channel
/// keeps the sum of its weights up to one rounding.
Int8Weights PackInt8(std::span<const float> weight, int out_channels, int in_channels, int kernel,
                     const ByteScale& input);

/// One run of a convolution of bytes, summed exactly as integers.
struct Int8Convolution {
  int kernel = 1;
  int stride = 1;
  float slope = 1;
  ByteScale scale;
  const Int8Weights* weights = nullptr;
  const float* bias = nullptr;  // of all channels of all blocks of the output
  TensorView input;             // floats, kBlocked, with their padding in the halo
  TensorView residual;          // data is null if there is none
  TensorView output;            // floats
};

/// Bytes of memory in which a kernel rounds the input of `rows` rows of the output.
std::size_t Int8ScratchBytes(const Shape& input, int kernel, int stride, int rows);

/// The rounded input of a band of rows, with its padding: [block][row][pixel][channel].
template <typename Byte>
struct ByteBand {
  const Byte* data;
  std::ptrdiff_t row;    // bytes of a row of a block
  std::ptrdiff_t plane;  // bytes of a block
};

/// Rounds what rows `first` to `last` - 1 of the output see of the input, into `scratch`. `round`
/// rounds a number of blocks of kInt8Block floats: (const float*, count, const ByteScale&, Byte*).
template <typename Byte, typename RoundBlocks>
ByteBand<Byte> RoundBand(const Int8Convolution& run, int first, int last, std::byte* scratch,
                         const RoundBlocks& round) {
  const int reach = run.kernel / 2;
  const int top = first * run.stride - reach;
  const int rows = (last - first - 1) * run.stride + run.kernel;
  const std::ptrdiff_t pixels = run.input.shape.width + 2 * reach;
  auto* const bytes = reinterpret_cast<Byte*>(scratch);
  const ByteBand<Byte> band{bytes, pixels * kInt8Block, rows * pixels * kInt8Block};
  for (int plane = 0; plane < run.input.planes(); ++plane) {
    for (int y = 0; y < rows; ++y) {
      round(run.input.row<float>(plane, top + y) - std::ptrdiff_t{reach} * kInt8Block, pixels,
            run.scale, bytes + plane * band.plane + y * band.row);
    }
  }
  return band;
}

/// Computes rows `first` to `last` - 1 of the output with AVX-512's VPDPBUSD, which the processor
/// must have. `scratch` has Int8ScratchBytes and is aligned to kAlignment.
void RunVnni(const Int8Convolution& run, int first, int last, std::byte* scratch);

/// The same with Arm's SDOT and bytes that have signs (`lowest` of the scale is -128).
void RunDotProduct(const Int8Convolution& run, int first, int last, std::byte* scratch);

}  // namespace orb360::nn
