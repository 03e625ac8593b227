#include "slam/viewer/view_files.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

DenseDepth Depth(int width, int height) {
  DenseDepth depth;
  depth.range.create(height, width, CV_32FC1);
  depth.confidence.create(height, width, CV_32FC1);
  depth.color = cv::Mat(height, width, CV_8UC3, cv::Scalar(30, 90, 200));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      depth.range.at<float>(y, x) =
          x == 0 ? 0.0f : 0.01f * std::exp(0.1f * static_cast<float>(x + y));
      depth.confidence.at<float>(y, x) = static_cast<float>(y) / static_cast<float>(height);
    }
  }
  return depth;
}

TEST(ViewFiles, KeepRangesAndConfidences) {
  const DenseDepth depth = Depth(64, 32);
  const std::string bytes = ViewRangeBytes(depth, 64);
  ASSERT_EQ(bytes.size(), 8U + 3 * 64 * 32);
  EXPECT_EQ(ReadNumber<std::uint32_t>(bytes, 0, std::endian::little), 64U);
  EXPECT_EQ(ReadNumber<std::uint32_t>(bytes, 4, std::endian::little), 32U);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      const size_t i = static_cast<size_t>(y) * 64 + static_cast<size_t>(x);
      const auto code = ReadNumber<std::uint16_t>(bytes, 8 + 2 * i, std::endian::little);
      const auto confidence = static_cast<unsigned char>(bytes[8 + 2 * 64 * 32 + i]);
      if (x == 0) {
        ASSERT_EQ(code, 0);
        ASSERT_EQ(confidence, 0);
        continue;
      }
      const double range = depth.range.at<float>(y, x);
      ASSERT_NEAR(std::exp((*code - 32768) / 1024.0) / range, 1.0, 5.5e-4);
      ASSERT_NEAR(confidence / 255.0, depth.confidence.at<float>(y, x), 0.5 / 255 + 1e-6);
    }
  }
}

TEST(ViewFiles, AreThinnedToTheWidthAskedFor) {
  const DenseDepth depth = Depth(100, 50);
  const std::string bytes = ViewRangeBytes(depth, 40);
  EXPECT_EQ(ReadNumber<std::uint32_t>(bytes, 0, std::endian::little), 33U);
  EXPECT_EQ(ReadNumber<std::uint32_t>(bytes, 4, std::endian::little), 16U);
  const auto code = ReadNumber<std::uint16_t>(bytes, 8 + 2 * (33 * 2 + 5), std::endian::little);
  EXPECT_NEAR(std::exp((*code - 32768) / 1024.0), depth.range.at<float>(7, 16), 1e-3);
}

TEST(ViewFiles, HaveImagesThatOthersRead) {
  const std::string bytes = ImageBytes(Depth(100, 50).color, 50);
  const cv::Mat image =
      cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
  ASSERT_EQ(image.size(), cv::Size(50, 25));
  const cv::Vec3b color = image.at<cv::Vec3b>(12, 25);
  EXPECT_NEAR(color[0], 30, 4);
  EXPECT_NEAR(color[1], 90, 4);
  EXPECT_NEAR(color[2], 200, 4);
}

}  // namespace
}  // namespace orb360
