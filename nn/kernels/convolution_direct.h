#pragma once

#include <cstddef>
#include <vector>

#include "nn/tensor.h"

namespace orb360::nn {

/// One run of the direct kernel: the sums of a convolution, window by window, without transforms.
struct DirectConvolution {
  int kernel = 1;
  int stride = 1;
  float slope = 1;
  /// Blocks of output channels that are computed together, group by group.
  const std::vector<int>* groups = nullptr;
  /// For every group: [input block][kernel row][kernel column][input channel][output channel].
  const float* weight = nullptr;
  /// Of every output channel of every group.
  const float* bias = nullptr;
  TensorView input;     // with its padding in its halo
  TensorView residual;  // data is null if there is none
  TensorView output;
};

/// How the blocks of output channels are best grouped on this processor.
std::vector<int> DirectGroups(int out_channels);

/// Computes rows `first` to `last` - 1 of the output.
void RunDirect(const DirectConvolution& run, int first, int last);

}  // namespace orb360::nn
