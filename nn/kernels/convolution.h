#pragma once

#include <span>
#include <vector>

#include "nn/base/aligned_vector.h"
#include "nn/tensor.h"

namespace orb360::nn {

/// What a convolution is besides its weights.
struct ConvolutionSpec {
  int in_channels = 1;
  int out_channels = 1;
  int kernel = 3;  // 1, 3 or 5
  int stride = 1;  // 1 or 2; output (y, x) is centred on input (stride * y, stride * x)
  Padding padding = Padding::kZero;
  /// Of the activation y = x > 0 ? x : slope * x: 1 for none, 0 for ReLU.
  float slope = 1;
};

/// The most input channels that may lie in kPlanar: pictures and the input of a network.
constexpr int kMaxPlanarChannels = 8;

/// A dense convolution with its weights packed in the order the kernel reads them, its bias, and
/// what usually follows: y = activation(convolution(x) + bias + residual). NaN and infinity spread
/// to the outputs whose window holds them, and to no others.
class Convolution {
 public:
  /// `weight` is out_channels x in_channels x kernel x kernel, row by row; `bias` has out_channels
  /// values or none.
  Convolution(const ConvolutionSpec& spec, std::span<const float> weight,
              std::span<const float> bias);

  const ConvolutionSpec& spec() const { return spec_; }
  Shape OutputShape(const Shape& input) const;

  /// Runs on floats. `input` is kBlocked, or kPlanar with up to kMaxPlanarChannels; its halo must
  /// be at least kernel / 2 and is overwritten with the padding. `output` is kBlocked or kPlanar
  /// and must not overlap the input. `residual`, if not null, has the output's shape and layout and
  /// may be the output itself. The same bits for any number of threads.
  void Run(const TensorView& input, const TensorView* residual, const TensorView& output,
           int threads) const;

 private:
  ConvolutionSpec spec_;
  std::vector<int> groups_;  // blocks of output channels that are computed together
  AlignedVector<float> weight_;
  AlignedVector<float> bias_;
};

}  // namespace orb360::nn
