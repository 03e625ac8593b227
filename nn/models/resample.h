#pragma once

#include <span>

namespace orb360::nn {

/// Rows and columns of a picture of the whole sphere, row by row in memory.
struct PictureSize {
  int height = 0;
  int width = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// Samples `from` at the pixel centres of `to`, linearly in both directions; columns continue at
/// the other side, rows repeat at the poles.
void ResampleBilinear(std::span<const float> from, PictureSize from_size, std::span<float> to,
                      PictureSize to_size);

/// Moves the points of a sparse picture (depth > 0) to the pixels of `to` that their centres fall
/// into; the rest becomes 0. Of several the nearest stays: it hides the others.
void ResamplePoints(std::span<const float> depth, std::span<const float> confidence,
                    PictureSize from_size, std::span<float> to_depth,
                    std::span<float> to_confidence, PictureSize to_size);

}  // namespace orb360::nn
