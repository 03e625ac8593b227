#pragma once

#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Writes the sine of each row's latitude: row v of H has sin(pi / 2 - pi (v + 0.5) / H). One
/// channel of floats, planar or blocked.
void LatitudeSine(const TensorView& y);

}  // namespace orb360::nn
