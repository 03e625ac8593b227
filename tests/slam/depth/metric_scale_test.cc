#include "slam/depth/metric_scale.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/camera.h"
#include "slam/geometry/so3.h"
#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);

// A street in units of 0.25 m: ground `height` below a tilted camera, walls 20 units to both sides.
struct Street {
  Street(double height, const Eigen::Quaterniond& camera_from_level, double noise)
      : up(camera_from_level * Eigen::Vector3d::UnitZ()) {
    RandomGeometry random(1);
    depth.range.create(kCamera.height(), kCamera.width(), CV_32F);
    ground.create(depth.range.size(), CV_32F);
    for (int y = 0; y < depth.range.rows; ++y) {
      for (int x = 0; x < depth.range.cols; ++x) {
        const Eigen::Vector3d ray =
            camera_from_level.conjugate() * kCamera.Bearing({x + 0.5, y + 0.5});
        const double to_wall = 20 / std::max(std::abs(ray.y()), 1e-3);
        const double to_ground = ray.z() < 0 ? height / -ray.z() : 1e9;
        ground.at<float>(y, x) = to_ground < to_wall ? 0.9F : 0.1F;
        depth.range.at<float>(y, x) =
            static_cast<float>(std::min(to_wall, to_ground) * std::exp(random.Normal(noise)));
      }
    }
  }
  DenseDepth depth;
  cv::Mat ground;
  Eigen::Vector3d up;
};

TEST(MetricScale, IsTheHeightOfTheCameraOverThatInTheMap) {
  for (const Eigen::Vector3d& tilt :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.08, -0.06, 0.7)}) {
    const Street street(8.0, ExpSo3(tilt), 0.0);
    for (const cv::Mat& ground : {street.ground, cv::Mat()}) {
      const auto scale = MeasureScale(street.depth, ground, 2.0, street.up, std::nullopt, {});
      ASSERT_TRUE(scale.has_value());
      // Where nothing tells ground from wall, the foot of the wall counts as well.
      const double tolerance = ground.empty() ? 1e-3 : 1e-5;
      EXPECT_NEAR(scale->log_scale, std::log(0.25), tolerance);
      EXPECT_NEAR(scale->sigma, MetricScaleOptions().height_sigma, tolerance);
    }
  }
}

TEST(MetricScale, OfNoisyDepthIsAsUncertainAsItSays) {
  const Street street(8.0, ExpSo3({0.05, 0.02, 0.0}), 0.02);
  // The "up" that is known is a little wrong as well.
  const Eigen::Vector3d up = ExpSo3({0.05, 0.05, 0.0}) * street.up;
  const auto scale = MeasureScale(street.depth, street.ground, 2.0, up, std::log(0.28), {});
  ASSERT_TRUE(scale.has_value());
  EXPECT_GT(scale->sigma, 0.01);
  EXPECT_LT(std::abs(scale->log_scale - std::log(0.25)), scale->sigma);
}

TEST(MetricScale, IsNotBelievedWhereTheNetworkThinksOtherwise) {
  const Street street(8.0, Eigen::Quaterniond::Identity(), 0.0);
  EXPECT_FALSE(MeasureScale(street.depth, street.ground, 2.0, street.up, std::log(0.5), {}));
  EXPECT_TRUE(MeasureScale(street.depth, street.ground, 2.0, street.up, std::log(0.3), {}));
}

TEST(MetricScale, IsUnknownWithoutGround) {
  const Street street(8.0, Eigen::Quaterniond::Identity(), 0.0);
  const cv::Mat none = cv::Mat::zeros(street.ground.size(), CV_32F);
  EXPECT_FALSE(MeasureScale(street.depth, none, 2.0, street.up, std::nullopt, {}));
  DenseDepth nothing;
  nothing.range = cv::Mat::zeros(street.ground.size(), CV_32F);
  EXPECT_FALSE(MeasureScale(nothing, {}, 2.0, street.up, std::nullopt, {}));
}

TEST(MetricScale, FusedIsTheMedianAndKnowsItsUncertainty) {
  RandomGeometry random(2);
  double worst_sigmas = 0;
  double squares = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<ScaleMeasurement> measurements;
    for (int i = 0; i < 25; ++i) {
      measurements.push_back({0.7 + random.Normal(0.03), 0.03});
    }
    const auto fused = FuseScales(measurements);
    ASSERT_TRUE(fused.has_value());
    const double error = (fused->log_scale - 0.7) / fused->sigma;
    squares += error * error;
    worst_sigmas = std::max(worst_sigmas, std::abs(error));
  }
  EXPECT_NEAR(std::sqrt(squares / kTrials), 1.0, 0.25);
  EXPECT_LT(worst_sigmas, 4.5);
}

TEST(MetricScale, FusedDoesNotFollowOutliers) {
  std::vector<ScaleMeasurement> measurements(12, {0.5, 0.02});
  measurements.insert(measurements.end(), 5, {2.0, 0.02});
  EXPECT_EQ(FuseScales(measurements)->log_scale, 0.5);
  // An uncertain majority neither.
  EXPECT_EQ(
      FuseScales(std::vector<ScaleMeasurement>{{1.0, 0.3}, {1.1, 0.3}, {0.5, 0.02}})->log_scale,
      0.5);
  EXPECT_FALSE(FuseScales({}).has_value());
}

}  // namespace
}  // namespace orb360
