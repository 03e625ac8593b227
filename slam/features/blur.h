#pragma once

#include <cstddef>
#include <cstdint>

namespace orb360 {

/// Gaussian blur of an image of `width` x `height` pixels: sigma of 2 pixels, 7 taps in each
/// direction, rounded to nearest after each direction. Reads 3 pixels beyond the image on all
/// sides. Strides are in bytes.
void BlurImage(const uint8_t* from, ptrdiff_t from_stride, int width, int height, uint8_t* to,
               ptrdiff_t to_stride);

}  // namespace orb360
