#pragma once

#include <span>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// A fully connected layer, y = weight x + bias, for tensors of 1 x 1 pixels.
class Dense {
 public:
  /// `weight` is [output][input].
  Dense(std::span<const float> weight, std::span<const float> bias, int outputs, int inputs);

  /// Floats; x and y may have different layouts. The layer is too small for several threads.
  void Run(const TensorView& x, const TensorView& y) const;

 private:
  int outputs_;
  int inputs_;
  int stride_;                 // outputs, rounded up to a whole block
  std::vector<float> weight_;  // [input][stride_], zero behind the last output
  std::vector<float> bias_;    // [stride_]
};

}  // namespace orb360::nn
