#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

constexpr float kUnitsPerMetre = 256.0f;

}  // namespace

void WriteDepthImage(const std::filesystem::path& path, const cv::Mat& range) {
  ORB360_CHECK(range.type() == CV_32FC1, range.type());
  cv::Mat units(range.size(), CV_16UC1);
  for (int row = 0; row < range.rows; ++row) {
    const float* from = range.ptr<float>(row);
    std::uint16_t* to = units.ptr<std::uint16_t>(row);
    for (int column = 0; column < range.cols; ++column) {
      const float rounded = std::round(from[column] * kUnitsPerMetre);
      to[column] = rounded > 0.0f && rounded <= 65535.0f ? static_cast<std::uint16_t>(rounded) : 0;
    }
  }
  std::vector<unsigned char> png;
  cv::imencode(".png", units, png);
  WriteFileAtomically(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

cv::Mat ReadDepthImage(const std::filesystem::path& path) {
  // OpenCV would print a message about an absent file to standard error.
  const cv::Mat units = std::filesystem::is_regular_file(path)
                            ? cv::imread(path.string(), cv::IMREAD_UNCHANGED)
                            : cv::Mat();
  if (units.type() != CV_16UC1 || units.empty()) {
    throw UserError(path.string() + ": is not a depth image (16-bit PNG, metres * 256)");
  }
  cv::Mat range;
  units.convertTo(range, CV_32F, 1.0 / kUnitsPerMetre);
  return range;
}

}  // namespace orb360
