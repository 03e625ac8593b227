#include "slam/depth/ground_probability.h"

#include <cmath>

#include <gtest/gtest.h>

#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// Ground wherever a ray points lower than `angle` radians below the horizon.
DenseDepth GroundBelow(double angle) {
  const EquirectangularCamera camera(512, 256);
  DenseDepth depth;
  depth.ground.create(256, 512, CV_32F);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) {
      const bool is_ground = camera.Bearing({x + 0.5, y + 0.5}).z() < -std::sin(angle);
      depth.ground.at<float>(y, x) = is_ground ? 1.0F : 0.0F;
    }
  }
  return depth;
}

TEST(GroundProbability, IsTheFractionOfTheCapBelow) {
  const double degree = std::acos(-1.0) / 180;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_DOUBLE_EQ(MeanGroundProbability(GroundBelow(0), up).value(), 1);
  // Caps of 45 and 60 degrees: 1 - cos 45 over 1 - cos 60.
  const double caps = (1 - std::cos(45 * degree)) / (1 - std::cos(60 * degree));
  EXPECT_NEAR(MeanGroundProbability(GroundBelow(45 * degree), up).value(), caps, 0.01);
}

TEST(GroundProbability, OfACameraOnItsSideIsThatOfTheWallBelow) {
  // Down is along y: of the cap of 60 degrees around it, the half towards -z is ground.
  EXPECT_NEAR(MeanGroundProbability(GroundBelow(0), -Eigen::Vector3d::UnitY()).value(), 0.5, 0.01);
  EXPECT_DOUBLE_EQ(MeanGroundProbability(GroundBelow(0), -Eigen::Vector3d::UnitZ()).value(), 0);
}

TEST(GroundProbability, IsEmptyWhereTheNetworkDoesNotTell) {
  EXPECT_EQ(MeanGroundProbability({}, Eigen::Vector3d::UnitZ()), std::nullopt);
}

}  // namespace
}  // namespace orb360
