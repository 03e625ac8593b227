#include "nn/kernels/normalized_convolution.h"

#include <cstddef>

#include "nn/base/check.h"

namespace orb360::nn {

NormalizedConvolution::NormalizedConvolution(std::span<const float> weight,
                                             std::span<const float> bias, int outputs, int inputs,
                                             int size, Padding padding)
    : outputs_(outputs),
      inputs_(inputs),
      size_(size),
      padding_(padding),
      weight_(weight.size()),
      bias_(bias.begin(), bias.end()),
      inverse_sum_(bias.size()) {
  ORB360_CHECK(outputs > 0 && inputs > 0 && size > 0 && size % 2 == 1, outputs, inputs, size);
  const std::size_t taps = static_cast<std::size_t>(inputs) * size * size;
  ORB360_CHECK(weight.size() == outputs * taps, weight.size(), outputs, inputs, size);
  ORB360_CHECK(static_cast<int>(bias.size()) == outputs, bias.size(), outputs);
  for (int o = 0; o < outputs; ++o) {
    double sum = 0;
    for (std::size_t tap = 0; tap < taps; ++tap) {
      weight_[tap * outputs + o] = weight[o * taps + tap];
      sum += weight[o * taps + tap];
    }
    inverse_sum_[o] = static_cast<float>(1 / sum);
  }
}

void NormalizedConvolution::Run(const TensorView& x, const TensorView& c, const TensorView& y,
                                const TensorView& y_confidence, int threads) const {
  for (const TensorView* tensor : {&x, &c, &y, &y_confidence}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
    ORB360_CHECK(tensor->shape.height == x.shape.height && tensor->shape.width == x.shape.width);
  }
  ORB360_CHECK(x.shape.channels == inputs_ && c.shape.channels == inputs_, x.shape.channels,
               c.shape.channels, inputs_);
  ORB360_CHECK(y.shape.channels == outputs_ && y_confidence.shape.channels == outputs_,
               y.shape.channels, y_confidence.shape.channels, outputs_);
  const int reach = size_ / 2;
  FillHalo(x, padding_, reach);
  FillHalo(c, padding_, reach);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < x.shape.height; ++v) {
    for (int o = 0; o < outputs_; ++o) {
      for (int u = 0; u < x.shape.width; ++u) {
        float numerator = 0;
        float denominator = 0;
        const float* w = weight_.data() + o;
        for (int i = 0; i < inputs_; ++i) {
          for (int dv = -reach; dv <= reach; ++dv) {
            for (int du = -reach; du <= reach; ++du, w += outputs_) {
              const float confidence = c.row<float>(i, v + dv)[u + du];
              numerator += *w * (x.row<float>(i, v + dv)[u + du] * confidence);
              denominator += *w * confidence;
            }
          }
        }
        y.row<float>(o, v)[u] = numerator / (denominator + 1e-20f) + bias_[o];
        y_confidence.row<float>(o, v)[u] = denominator * inverse_sum_[o];
      }
    }
  }
}

}  // namespace orb360::nn
