#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

constexpr float kUnitsPerMetre = 256.0f;
constexpr double kUnitsOfOne = 65535;

void WritePng(const std::filesystem::path& path, const cv::Mat& image) {
  std::vector<unsigned char> png;
  cv::imencode(".png", image, png);
  WriteFileAtomically(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

/// Returns an image of that type; `what` it should be.
cv::Mat ReadPng(const std::filesystem::path& path, int type, const std::string& what) {
  // OpenCV would print a message about an absent file to standard error.
  cv::Mat image = std::filesystem::is_regular_file(path)
                      ? cv::imread(path.string(), cv::IMREAD_UNCHANGED)
                      : cv::Mat();
  if (image.type() != type || image.empty()) {
    throw UserError(path.string() + ": is not " + what);
  }
  return image;
}

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
  WritePng(path, units);
}

cv::Mat ReadDepthImage(const std::filesystem::path& path) {
  cv::Mat range;
  ReadPng(path, CV_16UC1, "a depth image (16-bit PNG, metres * 256)")
      .convertTo(range, CV_32F, 1.0 / kUnitsPerMetre);
  return range;
}

void WriteFractionImage(const std::filesystem::path& path, const cv::Mat& fraction) {
  ORB360_CHECK(fraction.type() == CV_32FC1, fraction.type());
  cv::Mat units;
  fraction.convertTo(units, CV_16U, kUnitsOfOne);  // It rounds, and clamps to 0..65535.
  WritePng(path, units);
}

cv::Mat ReadFractionImage(const std::filesystem::path& path) {
  cv::Mat fraction;
  ReadPng(path, CV_16UC1, "an image of fractions (16-bit PNG, fraction * 65535)")
      .convertTo(fraction, CV_32F, 1.0 / kUnitsOfOne);
  return fraction;
}

void WriteSourceImage(const std::filesystem::path& path, const cv::Mat& source) {
  ORB360_CHECK(source.type() == CV_8UC1, source.type());
  WritePng(path, source);
}

cv::Mat ReadSourceImage(const std::filesystem::path& path) {
  const std::string what = "an image of sources (8-bit PNG, 0 to 4)";
  cv::Mat source = ReadPng(path, CV_8UC1, what);
  double largest = 0;
  cv::minMaxLoc(source, nullptr, &largest);
  if (largest > static_cast<double>(kRangeSources.back())) {
    throw UserError(path.string() + ": is not " + what);
  }
  return source;
}

}  // namespace orb360
