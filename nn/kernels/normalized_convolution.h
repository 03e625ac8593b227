#pragma once

#include <span>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// The weights of a normalized convolution: a weighted mean of the values that are known, with the
/// known fraction of the weights as the mean's confidence. Over input channels i and k x k taps,
///   N = sum w * (x * c),  D = sum w * c,  y = N / (D + 1e-20) + bias,  c' = D / sum w,
/// where the last sum counts every tap of the output channel, including those in the padding. Where
/// D = 0 the value is the bias. (Eldesokey, Felsberg, Khan: Confidence Propagation through CNNs for
/// Guided Sparse Depth Regression, PAMI 2019.) NormalizedChain runs it.
///
/// A NaN or infinity in x or c spreads to every output whose window contains it, even if the other
/// one of the two is zero.
class NormalizedConvolution {
 public:
  /// The largest kernel, 15 x 15.
  static constexpr int kMaxSize = 15;

  /// `weight` is [output][input][row][column], of an odd size; `bias` has one value for each
  /// output. For c' to be a confidence the weights must not be negative, and some of each output
  /// must be positive. This is not checked here; the caller knows where the weights come from.
  NormalizedConvolution(std::span<const float> weight, std::span<const float> bias, int outputs,
                        int inputs, int size, Padding padding);

  int outputs() const { return outputs_; }
  int inputs() const { return inputs_; }
  int size() const { return size_; }
  int reach() const { return size_ / 2; }
  Padding padding() const { return padding_; }

  /// [row][input][column][output]: the order in which they are summed.
  const float* weight() const { return weight_.data(); }
  const float* bias() const { return bias_.data(); }
  /// 1 / sum of the weights, for each output.
  const float* inverse_sum() const { return inverse_sum_.data(); }

 private:
  int outputs_;
  int inputs_;
  int size_;
  Padding padding_;
  std::vector<float> weight_;
  std::vector<float> bias_;
  std::vector<float> inverse_sum_;
};

}  // namespace orb360::nn
