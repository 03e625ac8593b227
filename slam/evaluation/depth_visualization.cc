#include "slam/evaluation/depth_visualization.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>

namespace orb360 {

cv::Mat DrawDepth(const DenseDepth& depth, double near, double far, int width) {
  ORB360_CHECK(0 < near && near < far && width >= 2, near, far, width);
  const cv::Size size(width, width * depth.range.rows / depth.range.cols);
  // Nearest pixels are used, because the mean of two ranges lies on neither surface.
  cv::Mat range;
  cv::resize(depth.range, range, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat shades(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const double fraction = std::log(far / range.at<float>(row, column)) / std::log(far / near);
      shades.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(255.0 * fraction);
    }
  }
  cv::Mat colors;
  cv::applyColorMap(shades, colors, cv::COLORMAP_TURBO);
  colors.setTo(cv::Scalar::all(0), range <= 0);

  std::vector<cv::Mat> panels(3);
  cv::resize(depth.color, panels[0], size, 0, 0, cv::INTER_AREA);
  panels[1] = colors;
  cv::Mat confidence;
  cv::resize(depth.confidence, confidence, size, 0, 0, cv::INTER_AREA);
  confidence.convertTo(confidence, CV_8U, 2.0 * 255.0, -255.0);
  cv::cvtColor(confidence, panels[2], cv::COLOR_GRAY2BGR);
  cv::Mat image;
  cv::vconcat(panels, image);
  return image;
}

}  // namespace orb360
