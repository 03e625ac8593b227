#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn::vulkan {

/// Collects what the shaders read beside tensors: weights and tables, in the order in which they
/// are read. Each function returns where its part begins.
class Constants {
 public:
  /// For shaders/convolution.comp, with groups of 4 `vectors` output channels: in vectors of four.
  std::uint32_t AddConvolution(const Weight& weight, const Weight& bias, int vectors);
  /// For shaders/normalized_convolution.comp: in vectors of four.
  std::uint32_t AddNormalizedConvolution(const Weight& weight, const Weight& bias);
  /// For shaders/dense.comp: in floats.
  std::uint32_t AddDense(const Weight& weight, const Weight& bias);
  /// Sine of the latitude of each of `height` rows: in floats.
  std::uint32_t AddLatitudeSines(int height);

  std::span<const float> values() const { return values_; }

 private:
  /// Returns the number of values, a multiple of four.
  std::uint32_t Align();
  /// Appends the kernels of `group` output channels from `first` on, [input][tap][output], with
  /// zeros for channels that do not exist.
  void AppendKernels(const Weight& weight, int first, int group);

  std::vector<float> values_;
};

}  // namespace orb360::nn::vulkan
