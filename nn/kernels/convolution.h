#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/base/cpu.h"
#include "nn/kernels/convolution_int8.h"
#include <orb360/nn/base/aligned_vector.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Parameters of a convolution other than its weights.
struct ConvolutionSpec {
  int in_channels = 1;
  int out_channels = 1;
  int kernel = 3;  // 1, 3 or 5
  int stride = 1;  // 1 or 2; output (y, x) is centred on input (stride * y, stride * x)
  Padding padding = Padding::kZero;
  /// Slope of the activation y = x > 0 ? x : slope * x: 1 for none, 0 for ReLU.
  float slope = 1;
  /// kBFloat16 rounds weights and inputs to bfloat16 and sums in floats. It needs a processor with
  /// a BFloat16Unit. kInt8 rounds weights and inputs to 8 bits and sums exactly. It needs a
  /// processor with a ByteUnit.
  DataType type = DataType::kFloat;
  /// Whether 3x3 convolutions of floats with many channels may be computed in tiles of
  /// kConvolutionTile x kConvolutionTile outputs by Winograd's method. That is 2 to 3 times as
  /// fast, and with a stride of 2 1.2 to 1.4 times (measured with AVX2). An image that is shifted
  /// by a fraction of a tile of outputs is then rounded differently.
  bool may_tile = true;
  /// For kInt8: the range of inputs that is rounded to 8 bits; what is outside becomes its end. NaN
  /// becomes the upper end.
  float minimum = 0;
  float maximum = 1;

  /// True if the convolution is computed in tiles by Winograd's method.
  bool is_winograd() const;
};

constexpr int kConvolutionTile = 4;

/// Largest number of input channels in kPlanar layout, for images and other inputs of a network.
/// With fewer channels than a block (16), too much of a block would be empty.
constexpr int kMaxPlanarChannels = 12;

/// A dense convolution with its weights in the order in which the kernel reads them, its bias, and
/// what usually follows: y = activation(convolution(x) + bias + residual). NaN and infinity spread
/// to the outputs whose window contains them, and to no others (not in 8 bits).
///
/// | type | input | output |
/// |---|---|---|
/// | float | float, blocked; up to kMaxPlanarChannels also planar | float, blocked or planar |
/// | bfloat16 | bfloat16, blocked | bfloat16, blocked; float, blocked or planar |
/// | bfloat16, up to kMaxPlanarChannels | float, planar, and not rounded | bfloat16, blocked |
/// | 8 bits | float, blocked | float, blocked or planar |
class Convolution {
 public:
  /// `weight` is out_channels x in_channels x kernel x kernel, row by row. `bias` has out_channels
  /// values or none. `unit` is the unit on which a bfloat16 convolution runs.
  Convolution(const ConvolutionSpec& spec, std::span<const float> weight,
              std::span<const float> bias, BFloat16Unit unit = BestBFloat16Unit());

  const ConvolutionSpec& spec() const { return spec_; }
  Shape OutputShape(const Shape& input) const;

  /// Bytes of scratch memory that Run needs for an input of that shape.
  std::size_t ScratchBytes(const Shape& input, int threads) const;

  /// The input's halo must be at least kernel / 2 and is overwritten with the padding. `output`
  /// must not overlap the input. `residual`, if not null, has the output's shape, layout and type
  /// and may be the output itself; it must be null when floats become bfloat16. `scratch`, of
  /// ScratchBytes(), is aligned to kAlignment. The bits are the same for any number of threads.
  void Run(const TensorView& input, const TensorView* residual, const TensorView& output,
           std::span<std::byte> scratch, int threads) const;

  /// For benchmarks: computes only the products of a convolution in tiles, of whatever is in
  /// `scratch`, without their transforms. Returns their number; 0 for other convolutions, which are
  /// not computed.
  std::int64_t RunProducts(const TensorView& input, std::span<std::byte> scratch,
                           int threads) const;

 private:
  // True if planar floats become blocks of bfloat16. The inputs of a network (positions,
  // logarithms) have more digits than a bfloat16, so they are multiplied as floats.
  bool is_bfloat16_stem() const {
    return spec_.type == DataType::kBFloat16 && spec_.in_channels <= kMaxPlanarChannels;
  }
  void CheckTensors(const TensorView& input, const TensorView* residual,
                    const TensorView& output) const;

  ConvolutionSpec spec_;
  BFloat16Unit unit_;
  std::vector<int> groups_;       // blocks of output channels that are computed together
  AlignedVector<float> weight_;   // for the direct kernel
  AlignedVector<float> filters_;  // for tiles
  AlignedVector<std::uint16_t> rounded_weight_;  // for `unit_`
  ByteScale scale_;                              // for 8 bits
  Int8Weights bytes_;                            // likewise
  AlignedVector<float> bias_;
};

}  // namespace orb360::nn
