#include "slam/stereo/speckles.h"

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(RemoveSpeckles, RemovesSmallSegmentsAndKeepsSurfacesThatSlope) {
  // A slope of one pixel a column, with a patch of 3 x 3 pixels that stands out of it.
  cv::Mat disparity(20, 40, CV_32F);
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column) {
      disparity.at<float>(row, column) = static_cast<float>(column);
    }
  }
  const cv::Rect patch(10, 5, 3, 3);
  disparity(patch) += 20;
  disparity.at<float>(15, 30) = -1;
  RemoveSpeckles({.min_fraction = 10.0 / 800, .max_difference = 1.5F}, &disparity);
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column) {
      const bool is_removed = patch.contains({column, row}) || (row == 15 && column == 30);
      EXPECT_EQ(disparity.at<float>(row, column), is_removed ? -1 : column) << row << ' ' << column;
    }
  }
}

TEST(RemoveSpeckles, KeepsSegmentsThatAreLargeEnoughOverTheSeam) {
  cv::Mat disparity(20, 40, CV_32F, cv::Scalar(-1));
  disparity(cv::Rect(0, 0, 4, 2)) = 7;   // the first and
  disparity(cv::Rect(0, 19, 4, 1)) = 7;  // the last rows: 12 pixels
  disparity(cv::Rect(39, 0, 1, 9)) = 7;  // the other end of these rows is no neighbour: 9 pixels
  RemoveSpeckles({.min_fraction = 12.0 / 800, .max_difference = 1.0F}, &disparity);
  EXPECT_EQ(cv::countNonZero(disparity == 7), 12);
  EXPECT_EQ(disparity.at<float>(0, 39), -1);
}

TEST(RemoveSpeckles, ContractsAreChecked) {
  cv::Mat bytes(4, 4, CV_8U);
  EXPECT_THROW(RemoveSpeckles({}, &bytes), ContractError);
}

}  // namespace
}  // namespace orb360
