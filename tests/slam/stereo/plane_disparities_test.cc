#include "slam/stereo/plane_disparities.h"

#include <cmath>

#include <gtest/gtest.h>

#include "slam/stereo/rectified_sphere.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kWidth = 128;
// A tilted plane, a camera 1.7 over it and another one beside it, which is higher.
const PlaneHypothesis kPlane{Eigen::Vector3d(0.1, -0.2, 1).normalized(), 1.7};
const Eigen::Vector3d kBaseline(0.6, -0.4, 0.2);

TEST(PlaneDisparities, AreThoseOfPointsOfThePlaneInBothViews) {
  const Eigen::Matrix3d axes = BaselineAxes(kBaseline);
  const PlaneHypothesis rectified{axes.transpose() * kPlane.normal, kPlane.distance};
  const cv::Mat disparities = PlaneDisparities(rectified, kBaseline.norm(), kWidth);
  ASSERT_EQ(disparities.size(), cv::Size(kWidth, 2 * kWidth));
  int num_seen = 0;
  for (int y = 0; y < disparities.rows; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector3d bearing = RectifiedBearing({x + 0.5, y + 0.5}, axes, kWidth);
      const double towards = -kPlane.normal.dot(bearing);
      const float disparity = disparities.at<float>(y, x);
      if (towards < -0.05) {
        EXPECT_LT(disparity, 0) << x << ", " << y;
      }
      if (towards < 0.05) continue;
      const Eigen::Vector3d point = bearing * kPlane.distance / towards;
      const Eigen::Vector2d there = RectifiedPixel(point - kBaseline, axes, kWidth);
      // The angle between the rows where the source is almost above the point, and where rows meet
      // at the poles, changes too quickly for every fourth bearing.
      EXPECT_NEAR(disparity, there.x() - (x + 0.5), 0.6) << x << ", " << y;
      ++num_seen;
    }
  }
  EXPECT_GT(num_seen, 0.4 * disparities.rows * kWidth);
}

TEST(PlaneDisparities, ChecksItsArguments) {
  const Eigen::Vector3d up(0, 0, 1);
  EXPECT_THROW(PlaneDisparities({up, 0}, 1, kWidth), ContractError);
  EXPECT_THROW(PlaneDisparities({up, 1}, 0, kWidth), ContractError);
  EXPECT_THROW(PlaneDisparities({up, 1}, 1, 126), ContractError);
}

}  // namespace
}  // namespace orb360
