#pragma once

#include <span>
#include <vector>

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

/// The same for a picture that may become much smaller: halved by means of 2 x 2 while it has at
/// least twice as many rows and columns, so that no pixel is passed over.
void ResampleImage(std::vector<float> from, PictureSize from_size, std::span<float> to,
                   PictureSize to_size);

/// Moves the points of a sparse picture (depth > 0) to the pixels of `to` that their centres fall
/// into; the rest becomes 0. Of several the nearest stays: it hides the others.
void ResamplePoints(std::span<const float> depth, std::span<const float> confidence,
                    PictureSize from_size, std::span<float> to_depth,
                    std::span<float> to_confidence, PictureSize to_size);

}  // namespace orb360::nn
