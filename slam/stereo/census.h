#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360 {

/// Number of bits of a signature.
inline constexpr int kCensusBits = 24;

/// Census transform (Zabih, Woodfill, ECCV 1994) of each pixel's 5 x 5 window: one bit for each
/// neighbour that is darker than the pixel. It does not depend on the exposure.
struct CensusImage {
  /// A signature is spread over this many planes of bytes.
  static constexpr int kNumPlanes = kCensusBits / 8;
  /// Bytes before and after each row that vector instructions may read.
  static constexpr int kMargin = 32;

  CensusImage(int columns, int rows);

  /// Where a row begins in each of the vectors below.
  std::size_t StartOf(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width + kMargin) + kMargin;
  }

  int width;
  int height;
  std::array<std::vector<std::uint8_t>, kNumPlanes> planes;
  /// The least cost of a match with a pixel: 0, or kCensusBits outside the image.
  std::vector<std::uint8_t> least_cost;
};

/// Rows wrap around, as those of a rectified sphere do; columns beyond the border repeat it.
/// `gray`: CV_8U, at least 5 x 5. `is_outside`: CV_8U, pixels that are not 0 count as outside the
/// image.
CensusImage TransformCensus(const cv::Mat& gray, const cv::Mat& is_outside, int num_threads = 1);

}  // namespace orb360
