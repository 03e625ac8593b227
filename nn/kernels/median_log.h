#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Computes sparse depth relative to its median, in logarithms. Points are the pixels whose depth
/// is finite and positive and whose confidence is positive. s is their median depth (the lower one
/// of an even number; 1 if there are none). x = ln(depth / s) and c = min(confidence, 1) at points,
/// 0 elsewhere; `median` (1 channel, 1 x 1) is s. NaN and infinity in the inputs do not spread: x,
/// c and s are always finite.
///
/// Planar floats of one channel. x and c must not be the inputs, and their rows may be overwritten
/// up to the next multiple of kAlignment.
void MedianLog(const TensorView& depth, const TensorView& confidence, const TensorView& x,
               const TensorView& c, const TensorView& median, int threads);

}  // namespace orb360::nn
