#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360 {

/// Number of bits of a signature.
inline constexpr int kCensusBits = 24;

/// Census transform (Zabih, Woodfill, ECCV 1994) of each pixel's 5 x 5 window: one bit for each
/// neighbour that is darker than the pixel. It does not depend on the exposure.
struct CensusImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> signatures;  ///< Row by row.

  const std::uint32_t* row(int y) const {
    return &signatures[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
  }
};

/// Rows wrap around, as those of a rectified sphere do; columns beyond the border repeat it.
/// `gray`: CV_8U, at least 5 x 5.
CensusImage TransformCensus(const cv::Mat& gray, int num_threads = 1);

}  // namespace orb360
