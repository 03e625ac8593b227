#pragma once

#include <span>
#include <vector>

#include <orb360/nn/models/image_size.h>

namespace orb360::nn {

/// Samples `from` at the pixel centres of `to`, linearly in both directions. Columns continue at
/// the other side, rows repeat at the poles.
void ResampleBilinear(std::span<const float> from, ImageSize from_size, std::span<float> to,
                      ImageSize to_size);

/// The same for an image that may become much smaller. It is halved by means of 2 x 2 while it has
/// at least twice as many rows and columns, so that no pixel is skipped.
void ResampleImage(std::vector<float> from, ImageSize from_size, std::span<float> to,
                   ImageSize to_size);

/// Moves the points of a sparse depth image (depth > 0) to the pixels of `to` that contain their
/// centres; all other pixels become 0. Of several points at one pixel the nearest is kept, because
/// it occludes the others.
void ResamplePoints(std::span<const float> depth, std::span<const float> confidence,
                    ImageSize from_size, std::span<float> to_depth, std::span<float> to_confidence,
                    ImageSize to_size);

}  // namespace orb360::nn
