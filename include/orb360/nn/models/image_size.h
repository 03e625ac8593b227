#pragma once

namespace orb360::nn {

/// Rows and columns of an image of the whole sphere, row by row in memory.
struct ImageSize {
  int height = 0;  ///< Number of rows, pixels.
  int width = 0;   ///< Number of columns, pixels.
  /// Compares height and width.
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

}  // namespace orb360::nn
