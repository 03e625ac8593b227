#include "nn/kernels/dense.h"

#include <cstddef>

#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr int kBlock = BlockOf(DataType::kFloat);

float* Element(const TensorView& tensor, int channel) {
  return tensor.layout == Layout::kPlanar
             ? tensor.row<float>(channel, 0)
             : tensor.row<float>(channel / kBlock, 0) + channel % kBlock;
}

}  // namespace

Dense::Dense(std::span<const float> weight, std::span<const float> bias, int outputs, int inputs)
    : outputs_(outputs),
      inputs_(inputs),
      stride_((outputs + kBlock - 1) / kBlock * kBlock),
      weight_(static_cast<std::size_t>(inputs) * stride_),
      bias_(stride_) {
  ORB360_CHECK(outputs > 0 && inputs > 0, outputs, inputs);
  ORB360_CHECK(weight.size() == static_cast<std::size_t>(outputs) * inputs, weight.size());
  ORB360_CHECK(static_cast<int>(bias.size()) == outputs, bias.size(), outputs);
  for (int o = 0; o < outputs; ++o) {
    bias_[o] = bias[o];
    for (int i = 0; i < inputs; ++i) {
      weight_[static_cast<std::size_t>(i) * stride_ + o] =
          weight[static_cast<std::size_t>(o) * inputs + i];
    }
  }
}

void Dense::Run(const TensorView& x, const TensorView& y) const {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat);
  ORB360_CHECK((x.shape == Shape{inputs_, 1, 1} && y.shape == Shape{outputs_, 1, 1}));
  for (int first = 0; first < stride_; first += kBlock) {
    float sum[kBlock];
    for (int o = 0; o < kBlock; ++o) sum[o] = bias_[first + o];
    const float* w = weight_.data() + first;
    for (int i = 0; i < inputs_; ++i, w += stride_) {
      const float value = *Element(x, i);
      for (int o = 0; o < kBlock; ++o) sum[o] += w[o] * value;
    }
    // In a blocked tensor the whole block is written, so that the channels that fill it up are
    // zero.
    const int count =
        y.layout == Layout::kBlocked || first + kBlock <= outputs_ ? kBlock : outputs_ - first;
    for (int o = 0; o < count; ++o) *Element(y, first + o) = sum[o];
  }
}

}  // namespace orb360::nn
