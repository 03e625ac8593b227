#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core.hpp>

namespace orb360 {

/// How a stored image is turned to be shown: first mirrored, then turned.
struct ImageOrientation {
  /// Left and right are exchanged.
  bool is_mirrored = false;
  /// Turns by 90 degrees clockwise after that, 0 to 3.
  int quarter_turns = 0;

  bool operator==(const ImageOrientation&) const = default;
};

/// Returns the orientation that a display matrix of a video track means (ISO 14496-12, 6.2.2: rows
/// a b u, c d v, x y w; a pixel (p, q) is shown at (a p + c q, b p + d q)), to the nearest right
/// angle.
ImageOrientation FromDisplayMatrix(std::span<const std::int32_t, 9> matrix);

/// Returns the image as it is to be shown.
cv::Mat Oriented(const cv::Mat& image, const ImageOrientation& orientation);

/// Returns the size of the image as shown.
cv::Size OrientedSize(cv::Size size, const ImageOrientation& orientation);

}  // namespace orb360
