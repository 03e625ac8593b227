#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Pixels of halo that x needs; its content is overwritten.
constexpr int kConvexUpsampleHalo = 1;

/// Channels of weights: nine neighbours for each of four output pixels.
constexpr int kConvexUpsampleWeights = 36;

/// Doubles the size. Each output pixel is a convex combination of 3 x 3 neighbours: output pixel
/// (2v + i, 2u + j) is the sum of x around (v, u), row by row, weighted by the softmax of channels
/// 9 (2i + j) to 9 (2i + j) + 8 of `weights`, which has the size of x. Planar floats.
void ConvexUpsample(const TensorView& x, const TensorView& weights, const TensorView& y,
                    Padding padding, int threads);

}  // namespace orb360::nn
