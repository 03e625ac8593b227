#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Halves the size: every pixel is the mean of a 2 x 2 square. Height and width of x must be even.
/// Floats, both of the same layout, planar or blocked. No halo is read, and rows of a planar output
/// may be overwritten up to the next multiple of kAlignment.
void AveragePool(const TensorView& x, const TensorView& y, int threads);

/// Computes the mean of every channel. y is 1 x 1 and may have another layout than x. Floats. A
/// channel is summed in one fixed order for any number of threads.
void GlobalAveragePool(const TensorView& x, const TensorView& y, int threads);

}  // namespace orb360::nn
