#include "slam/depth/ground_points.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
constexpr double kHeight = 1.5;

SparseDepth NoPoints() {
  return {cv::Mat::zeros(kCamera.height(), kCamera.width(), CV_32F),
          cv::Mat::zeros(kCamera.height(), kCamera.width(), CV_32F)};
}

TEST(AddGroundPoints, LieInThePlaneBelowATiltedCamera) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.2, -0.1, 1).normalized();
  SparseDepth sparse = NoPoints();
  EXPECT_TRUE(AddGroundPoints(up, kHeight, {}, &sparse));
  int num_points = 0;
  for (int row = 0; row < kCamera.height(); ++row) {
    for (int column = 0; column < kCamera.width(); ++column) {
      const float range = sparse.range.at<float>(row, column);
      if (!(range > 0)) continue;
      ++num_points;
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      EXPECT_NEAR(range * up.dot(bearing), -kHeight, 1e-5);
      EXPECT_LT(up.dot(bearing), -0.7);
      // An error of 10 % is half of full confidence.
      EXPECT_FLOAT_EQ(sparse.confidence.at<float>(row, column), 0.5F);
    }
  }
  EXPECT_GT(num_points, 50);
  EXPECT_EQ(cv::countNonZero(sparse.confidence), num_points);
}

TEST(AddGroundPoints, AreNotAddedWhereTheGroundWasMeasured) {
  SparseDepth sparse = NoPoints();
  for (int row = 100; row < 128; row += 4) {
    for (int column = 0; column < 256; column += 24) {
      sparse.range.at<float>(row, column) = 2;
      sparse.confidence.at<float>(row, column) = 0.9F;
    }
  }
  const cv::Mat before = sparse.range.clone();
  EXPECT_FALSE(AddGroundPoints(Eigen::Vector3d::UnitZ(), kHeight, {}, &sparse));
  EXPECT_EQ(cv::norm(sparse.range, before, cv::NORM_INF), 0);
}

TEST(AddGroundPoints, LeaveTheFewPointsThatThereAre) {
  SparseDepth sparse = NoPoints();
  sparse.range.at<float>(120, 100) = 7;
  sparse.confidence.at<float>(120, 100) = 0.9F;
  EXPECT_TRUE(AddGroundPoints(Eigen::Vector3d::UnitZ(), kHeight, {}, &sparse));
  EXPECT_EQ(sparse.range.at<float>(120, 100), 7);
  EXPECT_EQ(cv::countNonZero(sparse.range(cv::Rect(96, 120, 12, 8))), 1);
}

}  // namespace
}  // namespace orb360
