#pragma once

namespace orb360::nn {

/// Rows and columns of an image of the whole sphere, row by row in memory.
struct PictureSize {
  int height = 0;
  int width = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

}  // namespace orb360::nn
