#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Doubles the size: every pixel becomes a 2 x 2 square. Floats, both of the same layout, planar or
/// blocked. No halo is read, and rows of a planar output may be overwritten up to the next multiple
/// of kAlignment.
void UpsampleNearest(const TensorView& x, const TensorView& y, int threads);

/// Pixels of halo that the input of UpsampleBilinear needs; its content is overwritten.
constexpr int kUpsampleBilinearHalo = 1;

/// Doubles the size: output pixel u samples the input, linearly in both directions, at (u + 0.5) /
/// 2 - 0.5, with `padding` beyond the edge. Floats, both of the same layout, planar or blocked;
/// rows of a planar output may be overwritten as above.
void UpsampleBilinear(const TensorView& x, const TensorView& y, Padding padding, int threads);

}  // namespace orb360::nn
