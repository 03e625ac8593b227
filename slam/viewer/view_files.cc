#include "slam/viewer/view_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "slam/io/byte_number.h"
#include "slam/io/image_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr float kCodeOfOne = 32768;  // The middle: any unit of length has room.
constexpr float kStepsPerUnit = 1024;

/// The smallest step with which a width is at most `max_width`.
int StepFor(int width, int max_width) { return (width + max_width - 1) / max_width; }

}  // namespace

std::string ViewRangeBytes(const DenseDepth& depth, int max_width) {
  ORB360_CHECK(max_width > 0 && depth.range.type() == CV_32FC1 &&
               depth.confidence.size() == depth.range.size());
  const int step = StepFor(depth.range.cols, max_width);
  const int width = depth.range.cols / step;
  const int height = depth.range.rows / step;
  std::string bytes;
  AppendLittleEndian(static_cast<std::uint32_t>(width), &bytes);
  AppendLittleEndian(static_cast<std::uint32_t>(height), &bytes);
  std::string confidences;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // The pixel in the middle of the block that it stands for.
      const int row = y * step + step / 2;
      const int column = x * step + step / 2;
      const float range = depth.range.at<float>(row, column);
      const bool is_known = range > 0 && std::isfinite(range);
      const float code = is_known ? kCodeOfOne + kStepsPerUnit * std::log(range) : 0;
      AppendLittleEndian(
          static_cast<std::uint16_t>(is_known ? std::clamp(std::lround(code), 1L, 65535L) : 0),
          &bytes);
      const float confidence = is_known ? depth.confidence.at<float>(row, column) : 0;
      confidences += static_cast<char>(std::clamp(std::lround(255 * confidence), 0L, 255L));
    }
  }
  return bytes + confidences;
}

std::string ImageBytes(const cv::Mat& image, int max_width) {
  const int step = StepFor(image.cols, max_width);
  if (step == 1) return EncodeImage(".jpg", image);
  cv::Mat small;
  cv::resize(image, small, {image.cols / step, image.rows / step}, 0, 0, cv::INTER_AREA);
  return EncodeImage(".jpg", small);
}

}  // namespace orb360
