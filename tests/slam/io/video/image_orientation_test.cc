#include "slam/io/video/image_orientation.h"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

extern "C" {
#include <libavutil/display.h>
}

namespace orb360 {
namespace {

using Matrix = std::array<std::int32_t, 9>;

/// Where a display matrix shows the pixel at (x, y), up to a shift (ISO 14496-12, 6.2.2).
cv::Point2d Shown(const Matrix& matrix, double x, double y) {
  return {(matrix[0] * x + matrix[3] * y) / 65536.0, (matrix[1] * x + matrix[4] * y) / 65536.0};
}

// FFmpeg writes the matrices, and every pixel must land where the matrix says.
TEST(ImageOrientation, PutsEveryPixelWhereTheMatrixShowsIt) {
  cv::Mat image(2, 3, CV_8U);
  for (int i = 0; i < 6; ++i) image.data[i] = static_cast<uchar>(i);
  for (const bool is_mirrored : {false, true}) {
    for (int turns = 0; turns < 4; ++turns) {
      Matrix matrix{};
      av_display_rotation_set(matrix.data(), -90.0 * turns);
      if (is_mirrored) av_display_matrix_flip(matrix.data(), 1, 0);
      const ImageOrientation orientation = FromDisplayMatrix(matrix);
      const cv::Mat shown = Oriented(image, orientation);
      ASSERT_EQ(shown.size(), OrientedSize(image.size(), orientation));
      const cv::Point2d center(1.0, 0.5);
      const cv::Point2d shown_center((shown.cols - 1) / 2.0, (shown.rows - 1) / 2.0);
      for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
          const cv::Point2d at = shown_center + Shown(matrix, x - center.x, y - center.y);
          EXPECT_EQ(shown.at<uchar>(cv::Point(cvRound(at.x), cvRound(at.y))), image.at<uchar>(y, x))
              << "mirrored " << is_mirrored << ", turns " << turns;
        }
      }
    }
  }
}

}  // namespace
}  // namespace orb360
