#pragma once

#include <opencv2/core.hpp>

namespace orb360 {

/// An image whose pixels were taken from other columns of the same row of another one.
struct WarpedRows {
  cv::Mat image;       ///< Of the type of the other one.
  cv::Mat is_outside;  ///< CV_8U, 255 where the other column lies outside the image.
};

/// Samples `image` (CV_8U or CV_32F) at column x + disparity(x) of each row, linearly between
/// pixels, or at the border where that is outside. `disparity`: CV_32F, as large.
WarpedRows WarpRows(const cv::Mat& image, const cv::Mat& disparity);

}  // namespace orb360
