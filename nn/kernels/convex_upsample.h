#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Pixels of halo that x needs; its content is overwritten.
constexpr int kConvexUpsampleHalo = 1;

/// Channels of weights: nine neighbours for each output pixel of an input pixel.
constexpr int ConvexUpsampleWeights(int factor) { return 9 * factor * factor; }

/// Multiplies the size by a factor f of 1 or 2. Each output pixel is a convex combination of 3 x 3
/// neighbours: output pixel (f v + i, f u + j) is the sum of x around (v, u), row by row, weighted
/// by the softmax of channels 9 (f i + j) to 9 (f i + j) + 8 of `weights`, which has the size of x.
/// Planar floats.
void ConvexUpsample(const TensorView& x, const TensorView& weights, const TensorView& y, int factor,
                    Padding padding, int threads);

}  // namespace orb360::nn
