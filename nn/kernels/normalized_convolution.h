#pragma once

#include <span>
#include <vector>

#include "nn/tensor.h"

namespace orb360::nn {

/// Normalized convolution: a weighted mean of the values that are known, with the known share of
/// the weights as the mean's confidence. Over input channels i and the k x k taps,
///   N = sum w * (x * c),  D = sum w * c,  y = N / (D + 1e-20) + bias,  c' = D / sum w,
/// where the last sum counts every tap of the output channel, those in the padding too. Where D = 0
/// the value is the bias. (Eldesokey, Felsberg, Khan: Confidence Propagation through CNNs for
/// Guided Sparse Depth Regression, PAMI 2019.)
///
/// A NaN or infinity in x or c spreads to every output whose window holds it, also where the other
/// of both is zero.
class NormalizedConvolution {
 public:
  /// `weight` is [output][input][row][column], k odd; `bias` has one value for each output. Sums of
  /// weights must be positive and weights not negative for c' to be a confidence; neither is
  /// checked here.
  NormalizedConvolution(std::span<const float> weight, std::span<const float> bias, int outputs,
                        int inputs, int size, Padding padding);

  /// Pixels of halo that inputs need; what stands there is overwritten.
  int halo() const { return size_ / 2; }

  /// x, c: `inputs` channels; y, y_confidence: `outputs` channels of the same height and width. All
  /// are planar floats and none of the outputs is an input. The result is the same for any number
  /// of threads.
  void Run(const TensorView& x, const TensorView& c, const TensorView& y,
           const TensorView& y_confidence, int threads) const;

 private:
  int outputs_;
  int inputs_;
  int size_;
  Padding padding_;
  std::vector<float> weight_;  // [input][row][column][output]
  std::vector<float> bias_;
  std::vector<float> inverse_sum_;  // 1 / sum of the output channel's weights
};

}  // namespace orb360::nn
