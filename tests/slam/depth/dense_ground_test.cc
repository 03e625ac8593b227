#include "slam/depth/dense_ground.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);

// A street in units of 0.25 m: ground `height` below a tilted camera, walls 20 units to both sides.
struct Street {
  Street(double height, const Eigen::Quaterniond& camera_from_level, double noise)
      : up(camera_from_level * Eigen::Vector3d::UnitZ()) {
    RandomGeometry random(1);
    depth.range.create(kCamera.height(), kCamera.width(), CV_32F);
    depth.ground.create(depth.range.size(), CV_32F);
    for (int y = 0; y < depth.range.rows; ++y) {
      for (int x = 0; x < depth.range.cols; ++x) {
        const Eigen::Vector3d ray =
            camera_from_level.conjugate() * kCamera.Bearing({x + 0.5, y + 0.5});
        const double to_wall = 20 / std::max(std::abs(ray.y()), 1e-3);
        const double to_ground = ray.z() < 0 ? height / -ray.z() : 1e9;
        depth.ground.at<float>(y, x) = to_ground < to_wall ? 0.9F : 0.1F;
        depth.range.at<float>(y, x) =
            static_cast<float>(std::min(to_wall, to_ground) * std::exp(random.Normal(noise)));
      }
    }
  }
  DenseDepth depth;
  Eigen::Vector3d up;
};

TEST(DenseGround, LiesAsFarBelowTheCameraAsItDoes) {
  for (const Eigen::Vector3d& tilt :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.08, -0.06, 0.7)}) {
    for (const bool is_told : {true, false}) {
      Street street(8.0, ExpSo3(tilt), 0.0);
      if (!is_told) street.depth.ground.release();
      const auto ground = FindGround(street.depth, street.up, {});
      ASSERT_TRUE(ground.has_value());
      // Where nothing tells ground from wall, the foot of the wall counts as well.
      const double tolerance = is_told ? 1e-5 : 1e-3;
      EXPECT_NEAR(ground->log_height, std::log(8.0), tolerance);
      EXPECT_NEAR(ground->sigma, DenseGroundOptions().height_sigma, tolerance);
      EXPECT_LT((ground->up - street.up).norm(), 10 * tolerance);
    }
  }
}

TEST(DenseGround, OfNoisyDepthIsAsUncertainAsItSays) {
  Street street(8.0, ExpSo3({0.05, 0.02, 0.0}), 0.02);
  street.depth.log_camera_height = std::log(7.0);
  // The "up" that is known is a little wrong as well.
  const Eigen::Vector3d up = ExpSo3({0.05, 0.05, 0.0}) * street.up;
  const auto ground = FindGround(street.depth, up, {});
  ASSERT_TRUE(ground.has_value());
  EXPECT_GT(ground->sigma, 0.01);
  EXPECT_LT(std::abs(ground->log_height - std::log(8.0)), ground->sigma);
}

TEST(DenseGround, IsNotBelievedWhereTheNetworkThinksOtherwise) {
  Street street(8.0, Eigen::Quaterniond::Identity(), 0.0);
  street.depth.log_camera_height = std::log(4.0);
  EXPECT_FALSE(FindGround(street.depth, street.up, {}));
  street.depth.log_camera_height = std::log(7.0);
  EXPECT_TRUE(FindGround(street.depth, street.up, {}));
}

TEST(DenseGround, IsUnknownWhereThereIsNone) {
  Street street(8.0, Eigen::Quaterniond::Identity(), 0.0);
  street.depth.ground = 0.0F;
  EXPECT_FALSE(FindGround(street.depth, street.up, {}));
  DenseDepth nothing;
  nothing.range = cv::Mat::zeros(street.depth.range.size(), CV_32F);
  EXPECT_FALSE(FindGround(nothing, street.up, {}));
}

DenseGround Level(double log_height, double sigma) {
  return {Eigen::Vector3d::UnitZ(), log_height, sigma};
}

TEST(DenseGround, FusedIsTheMedianAndKnowsItsUncertainty) {
  RandomGeometry random(2);
  double worst_sigmas = 0;
  double squares = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<DenseGround> grounds;
    for (int i = 0; i < 25; ++i) grounds.push_back(Level(0.7 + random.Normal(0.03), 0.03));
    const auto fused = FuseGrounds(grounds);
    ASSERT_TRUE(fused.has_value());
    const double error = (fused->log_height - 0.7) / fused->sigma;
    squares += error * error;
    worst_sigmas = std::max(worst_sigmas, std::abs(error));
  }
  EXPECT_NEAR(std::sqrt(squares / kTrials), 1.0, 0.25);
  EXPECT_LT(worst_sigmas, 4.5);
}

TEST(DenseGround, FusedDoesNotFollowOutliers) {
  std::vector<DenseGround> grounds(12, Level(0.5, 0.02));
  grounds.insert(grounds.end(), 5, Level(2.0, 0.02));
  EXPECT_EQ(FuseGrounds(grounds)->log_height, 0.5);
  // An uncertain majority neither.
  EXPECT_EQ(
      FuseGrounds(std::vector{Level(1.0, 0.3), Level(1.1, 0.3), Level(0.5, 0.02)})->log_height,
      0.5);
  EXPECT_FALSE(FuseGrounds({}).has_value());
}

TEST(DenseGround, FusedIsLevelInTheMean) {
  const DenseGround uphill{Eigen::Vector3d(0.1, 0, 1).normalized(), 0.5, 0.02};
  const DenseGround downhill{Eigen::Vector3d(-0.1, 0, 1).normalized(), 0.5, 0.02};
  EXPECT_LT((FuseGrounds(std::vector{uphill, downhill})->up - Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
}

}  // namespace
}  // namespace orb360
