#include "slam/evaluation/depth_visualization.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(DrawDepth, HasTheImageTheRangeAndTheConfidence) {
  DenseDepth depth{cv::Mat(32, 64, CV_32F, cv::Scalar(2.0)),
                   cv::Mat(32, 64, CV_32F, cv::Scalar(0.75)),
                   cv::Mat(32, 64, CV_8UC3, cv::Scalar(1, 2, 3))};
  depth.range.colRange(0, 16) = 1.0;
  depth.range.colRange(48, 64) = 0.0;
  depth.range.colRange(32, 48) = 100.0;
  const cv::Mat image = DrawDepth(depth, 1.0, 100.0, 128);
  ASSERT_EQ(image.size(), cv::Size(128, 192));
  EXPECT_EQ(image.at<cv::Vec3b>(30, 60), cv::Vec3b(1, 2, 3));
  const auto range = [&](int column) { return image.at<cv::Vec3b>(96, column); };
  EXPECT_GT(range(10)[2], 2 * range(10)[0]);  // near: red
  EXPECT_GT(range(80)[0], 2 * range(80)[1]);  // far: blue
  EXPECT_EQ(range(120), cv::Vec3b(0, 0, 0));
  EXPECT_NE(range(40), range(10));
  EXPECT_EQ(image.at<cv::Vec3b>(160, 60), cv::Vec3b::all(128));
}

}  // namespace
}  // namespace orb360
