#include "slam/depth/occluding_boundary.h"

#include <limits>

#include <gtest/gtest.h>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// 4 m everywhere, but 2 m in a rectangle.
cv::Mat NearRectangle(const cv::Rect& rectangle) {
  cv::Mat range(64, 128, CV_32F, cv::Scalar(4));
  range(rectangle).setTo(2);
  return range;
}

TEST(FindOccludingBoundary, IsTheRimOfWhatIsNear) {
  const cv::Rect near(40, 20, 20, 10);
  const cv::Mat boundary = FindOccludingBoundary(NearRectangle(near), {.width = 3});
  cv::Mat expected = cv::Mat::zeros(64, 128, CV_8U);
  expected(near).setTo(255);
  expected(cv::Rect(43, 23, 14, 4)).setTo(0);
  EXPECT_EQ(cv::norm(boundary, expected, cv::NORM_INF), 0);
}

TEST(FindOccludingBoundary, IsWhereASurfaceEndsAtTheSkyAndNotInTheSky) {
  cv::Mat range(64, 128, CV_32F, cv::Scalar(10));
  range.rowRange(0, 30).setTo(std::numeric_limits<float>::infinity());
  const cv::Mat boundary = FindOccludingBoundary(range, {.width = 3});
  for (const int row : {0, 29, 33, 63}) EXPECT_EQ(boundary.at<uchar>(row, 64), 0) << row;
  for (const int row : {30, 32}) EXPECT_EQ(boundary.at<uchar>(row, 64), 255) << row;
}

TEST(FindOccludingBoundary, ContinuesAcrossTheSeam) {
  const cv::Mat range = NearRectangle({0, 20, 20, 10});
  const cv::Mat boundary = FindOccludingBoundary(range, {.width = 2});
  EXPECT_EQ(boundary.at<uchar>(25, 1), 255);
  EXPECT_EQ(boundary.at<uchar>(25, 2), 0);
  cv::Mat turned;
  cv::hconcat(range.colRange(64, 128), range.colRange(0, 64), turned);
  cv::Mat turned_boundary;
  cv::hconcat(boundary.colRange(64, 128), boundary.colRange(0, 64), turned_boundary);
  EXPECT_EQ(cv::norm(FindOccludingBoundary(turned, {.width = 2}), turned_boundary, cv::NORM_INF),
            0);
}

TEST(FindOccludingBoundary, IsNotOnLevelGroundNorWhereNothingIsKnown) {
  const EquirectangularCamera camera(256, 128);
  cv::Mat range = cv::Mat::zeros(128, 256, CV_32F);
  for (int row = 0; row < 128; ++row) {
    const double down = -camera.Bearing({0.5, row + 0.5}).z();
    // Up to ten heights away, with the horizon unknown.
    if (down > 0.15) range.row(row).setTo(1.5 / down);
  }
  ASSERT_GT(cv::countNonZero(range), 10'000);
  EXPECT_EQ(cv::countNonZero(FindOccludingBoundary(range, {.width = 1})), 0);
}

}  // namespace
}  // namespace orb360
