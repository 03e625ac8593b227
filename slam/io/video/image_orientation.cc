#include "slam/io/video/image_orientation.h"

#include <cmath>
#include <numbers>

namespace orb360 {

ImageOrientation FromDisplayMatrix(std::span<const std::int32_t, 9> matrix) {
  const double a = matrix[0];
  const double b = matrix[1];
  const double c = matrix[3];
  const double d = matrix[4];
  ImageOrientation orientation;
  orientation.is_mirrored = a * d - b * c < 0.0;
  // Mirrored first, the column axis is reversed before the turn.
  const double sign = orientation.is_mirrored ? -1.0 : 1.0;
  const double clockwise = std::atan2(sign * b, sign * a);  // rows count downwards
  orientation.quarter_turns =
      (static_cast<int>(std::lround(clockwise / (std::numbers::pi / 2))) + 4) % 4;
  return orientation;
}

cv::Mat Oriented(const cv::Mat& image, const ImageOrientation& orientation) {
  cv::Mat mirrored;
  if (orientation.is_mirrored) cv::flip(image, mirrored, 1);
  const cv::Mat& result = orientation.is_mirrored ? mirrored : image;
  if (orientation.quarter_turns == 0) return result;
  constexpr cv::RotateFlags kTurns[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                        cv::ROTATE_90_COUNTERCLOCKWISE};
  cv::Mat turned;
  cv::rotate(result, turned, kTurns[orientation.quarter_turns - 1]);
  return turned;
}

cv::Size OrientedSize(cv::Size size, const ImageOrientation& orientation) {
  return orientation.quarter_turns % 2 == 0 ? size : cv::Size(size.height, size.width);
}

}  // namespace orb360
