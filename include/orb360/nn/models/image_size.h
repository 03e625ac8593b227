#pragma once

namespace orb360::nn {

/// Rows and columns of an image of the whole sphere, row by row in memory.
struct ImageSize {
  int height = 0;
  int width = 0;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

}  // namespace orb360::nn
