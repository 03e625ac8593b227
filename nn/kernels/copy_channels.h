#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Copies channels `from_first` to `from_first + count - 1` of `from` to the channels of `to` from
/// `to_first` on, between any layouts and data types. Height and width must be equal. The channels
/// that fill up the last block of `to` become zero when its last channel is written. Rounds to
/// nearest, ties to even, when converting to bfloat16. No halo is read or written.
void CopyChannels(const TensorView& from, int from_first, const TensorView& to, int to_first,
                  int count, int threads);

}  // namespace orb360::nn
