#pragma once

#include <cstddef>
#include <vector>

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// One run of the direct kernel: the sums of a convolution window by window, without transforms.
struct DirectConvolution {
  int kernel = 1;
  int stride = 1;
  float slope = 1;
  /// Numbers of blocks of output channels that are computed together, group by group.
  const std::vector<int>* groups = nullptr;
  /// For every group: [input block][kernel row][kernel column][input channel][output channel].
  const float* weight = nullptr;
  /// Bias of every output channel of every group.
  const float* bias = nullptr;
  TensorView input;     // with its padding in its halo
  TensorView residual;  // data is null if there is none
  TensorView output;
};

/// Returns the best grouping of the blocks of output channels on this processor.
std::vector<int> DirectGroups(int out_channels);

/// A part of a tensor's rows and columns, without the ends.
struct Rectangle {
  int top = 0;
  int bottom = 0;
  int left = 0;
  int right = 0;
};

/// Computes a part of the output.
void RunDirect(const DirectConvolution& run, const Rectangle& part);

}  // namespace orb360::nn
