#include "slam/stereo/rectified_sphere.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/dispatch_targets.h"
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

constexpr int kWidth = 128;
const std::vector<Eigen::Vector3d> kDirections = {
    {1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0.3, -0.5, 0.8}, {-0.7, 0.1, -0.2}, {-1e-9, 1, 1e-9}};

TEST(BaselineAxes, AreOrthonormalAndBeginWithTheBaseline) {
  for (const Eigen::Vector3d& baseline : kDirections) {
    const Eigen::Matrix3d axes = BaselineAxes(3 * baseline);
    EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(axes.determinant(), 1, 1e-12);
    EXPECT_LT((axes.col(0) - baseline.normalized()).norm(), 1e-12);
  }
}

TEST(RectifiedSphere, PixelAndBearingAreInverse) {
  const Eigen::Matrix3d axes = BaselineAxes({0.2, 0.9, -0.4});
  for (const double x : {0.5, 17.2, 64.0, 127.5}) {
    for (const double y : {0.1, 3.3, 128.0, 255.9}) {
      const Eigen::Vector3d bearing = RectifiedBearing({x, y}, axes, kWidth);
      EXPECT_NEAR(bearing.norm(), 1, 1e-12);
      EXPECT_LT((RectifiedPixel(2.5 * bearing, axes, kWidth) - Eigen::Vector2d(x, y)).norm(), 1e-9);
    }
  }
}

TEST(RectifiedSphere, APointLiesInTheSameRowOfBothCamerasApartByItsTriangulationAngle) {
  const Eigen::Vector3d baseline(0.3, -0.2, 0.1);
  const Eigen::Matrix3d axes = BaselineAxes(baseline);
  for (const Eigen::Vector3d& direction : kDirections) {
    const Eigen::Vector3d point = 4 * direction + Eigen::Vector3d(0.2, 0.3, -0.1);
    const Eigen::Vector2d first = RectifiedPixel(point, axes, kWidth);
    const Eigen::Vector2d second = RectifiedPixel(point - baseline, axes, kWidth);
    EXPECT_NEAR(first.y(), second.y(), 1e-9);
    EXPECT_NEAR((second.x() - first.x()) * std::numbers::pi / kWidth,
                AngleBetween(point, point - baseline), 1e-9);
  }
}

TEST(RectifySphere, ShowsEachDirectionWhereItsPixelIs) {
  // Brightness that changes linearly with the direction, also across both poles and the seam.
  const Eigen::Vector3d light(60, -50, 70);
  const EquirectangularCamera camera(256, 128);
  cv::Mat gray(128, 256, CV_8U);
  for (int v = 0; v < gray.rows; ++v) {
    for (int u = 0; u < gray.cols; ++u) {
      gray.at<uint8_t>(v, u) =
          cv::saturate_cast<uint8_t>(128 + light.dot(camera.Bearing({u + 0.5, v + 0.5})));
    }
  }
  for (const Eigen::Vector3d& baseline : kDirections) {
    const Eigen::Matrix3d axes = BaselineAxes(baseline);
    const cv::Mat rectified = RectifySphere(gray, axes, kWidth);
    ASSERT_EQ(rectified.size(), cv::Size(kWidth, 2 * kWidth));
    for (int y = 0; y < rectified.rows; ++y) {
      for (int x = 0; x < rectified.cols; ++x) {
        const double expected = 128 + light.dot(RectifiedBearing({x + 0.5, y + 0.5}, axes, kWidth));
        ASSERT_NEAR(rectified.at<uint8_t>(y, x), expected, 1.1) << x << ", " << y;
      }
    }
  }
}

TEST(UnrectifySphere, GivesBackWhatIsKnownByDirectionOnEveryInstructionSet) {
  // 1 / range of a plane is linear in the direction.
  const Eigen::Vector3d plane(0.3, -0.2, 0.5);
  const EquirectangularCamera camera(256, 128);
  ForEachDispatchTarget([&] {
    for (const Eigen::Vector3d& baseline : kDirections) {
      const Eigen::Matrix3d axes = BaselineAxes(baseline);
      InverseRanges rectified{cv::Mat::zeros(2 * kWidth, kWidth, CV_32F),
                              cv::Mat::zeros(2 * kWidth, kWidth, CV_32F)};
      for (int y = 0; y < 2 * kWidth; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const double value = plane.dot(RectifiedBearing({x + 0.5, y + 0.5}, axes, kWidth));
          if (value < 0.02) continue;
          rectified.value.at<float>(y, x) = static_cast<float>(value);
          rectified.sigma.at<float>(y, x) = 0.01f;
        }
      }
      const InverseRanges ranges = UnrectifySphere(rectified, axes, {256, 128});
      for (int v = 0; v < 128; ++v) {
        for (int u = 0; u < 256; ++u) {
          const Eigen::Vector3d bearing = camera.Bearing({u + 0.5, v + 0.5});
          const double value = plane.dot(bearing);
          const double from_pole = axes.col(0).cross(bearing).norm();
          if (value < -0.02) {
            ASSERT_EQ(ranges.sigma.at<float>(v, u), 0) << u << ", " << v;
          } else if (value > 0.3 && from_pole > 0.03) {
            ASSERT_NEAR(ranges.value.at<float>(v, u), value, 0.002) << u << ", " << v;
            ASSERT_EQ(ranges.sigma.at<float>(v, u), 0.01f);
          }
        }
      }
    }
  });
}

TEST(UnrectifySphere, DoesNotMixTwoSurfaces) {
  const Eigen::Matrix3d axes = BaselineAxes({1, 0, 0});
  InverseRanges rectified{cv::Mat(2 * kWidth, kWidth, CV_32F, 0.1),
                          cv::Mat(2 * kWidth, kWidth, CV_32F, 0.01)};
  rectified.value.colRange(0, kWidth / 2) = 0.5;
  const InverseRanges ranges = UnrectifySphere(rectified, axes, {256, 128});
  for (int v = 0; v < 128; ++v) {
    for (int u = 0; u < 256; ++u) {
      const float value = ranges.value.at<float>(v, u);
      EXPECT_TRUE(std::abs(value - 0.1f) < 1e-5 || std::abs(value - 0.5f) < 1e-5) << value;
    }
  }
}

}  // namespace
}  // namespace orb360
