#include "slam/io/export/sharpness.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace orb360 {

double MeasureSharpness(const cv::Mat& panorama, const cv::Mat& mask) {
  constexpr int kMaxWidth = 2048;  // pixels
  cv::Mat gray;
  cv::cvtColor(panorama, gray, cv::COLOR_BGR2GRAY);
  if (gray.cols > kMaxWidth) {
    cv::resize(gray, gray, {kMaxWidth, kMaxWidth * gray.rows / gray.cols}, 0, 0, cv::INTER_AREA);
  }
  cv::Mat counts;
  if (!mask.empty()) cv::resize(mask, counts, gray.size(), 0, 0, cv::INTER_NEAREST);
  cv::Mat laplacian;
  cv::Laplacian(gray, laplacian, CV_16S);
  double weight = 0;
  double sum = 0;
  double squares = 0;
  for (int row = 0; row < laplacian.rows; ++row) {
    const double solid_angle = std::sin(std::numbers::pi * (row + 0.5) / laplacian.rows);
    const auto* values = laplacian.ptr<int16_t>(row);
    for (int column = 0; column < laplacian.cols; ++column) {
      if (!counts.empty() && counts.at<uint8_t>(row, column) == 0) continue;
      const double value = values[column];
      weight += solid_angle;
      sum += solid_angle * value;
      squares += solid_angle * value * value;
    }
  }
  if (!(weight > 0)) return 0;
  const double mean = sum / weight;
  return std::sqrt(std::max(0.0, squares / weight - mean * mean));
}

}  // namespace orb360
