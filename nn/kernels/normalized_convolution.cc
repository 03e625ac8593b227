#include "nn/kernels/normalized_convolution.h"

#include <cstddef>

#include <orb360/nn/base/check.h>

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
  ORB360_CHECK(outputs > 0 && inputs > 0, outputs, inputs);
  ORB360_CHECK(size > 0 && size % 2 == 1 && size <= kMaxSize, size);
  const std::size_t taps = static_cast<std::size_t>(inputs) * size * size;
  ORB360_CHECK(weight.size() == outputs * taps, weight.size(), outputs, inputs, size);
  ORB360_CHECK(static_cast<int>(bias.size()) == outputs, bias.size(), outputs);
  for (int o = 0; o < outputs; ++o) {
    double sum = 0;
    for (int i = 0; i < inputs; ++i) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          const float w =
              weight[((static_cast<std::size_t>(o) * inputs + i) * size + row) * size + column];
          weight_[((static_cast<std::size_t>(row) * inputs + i) * size + column) * outputs + o] = w;
          sum += w;
        }
      }
    }
    inverse_sum_[o] = static_cast<float>(1 / sum);
  }
}

}  // namespace orb360::nn
