#include "slam/pipeline/ground.h"

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

// A camera 1.5 over the plane z = 0 of a world that is tilted by `tilt` in the map.
Map MapOverGround(const Eigen::Quaterniond& tilt, double ground_fraction) {
  SyntheticScene scene(400, 2.0, 8.0);
  for (size_t i = 0; i < scene.points.size(); ++i) {
    Eigen::Vector3d& p = scene.points[i].position;
    p.z() = i < ground_fraction * static_cast<double>(scene.points.size())
                ? -1.5 + scene.random.Normal(0.02)
                : scene.random.Uniform(-1.4, 4.0);
  }
  for (SyntheticScene::Point& point : scene.points) point.position = tilt * point.position;
  return scene.MakeMap(Walk(3, {-0.3, 0.0, 0.0}), 400);
}

std::optional<KnownGround> GroundOf(const Map& map) {
  return EstimateGround(map, map.KeyframeIds());
}

TEST(Ground, IsThePlaneBelowATiltedCamera) {
  const Eigen::Quaterniond tilt = ExpSo3({0.2, -0.15, 0.4});
  const auto ground = GroundOf(MapOverGround(tilt, 0.5));
  ASSERT_TRUE(ground.has_value());
  // The walk goes straight on, over or into the slope: the second of three cameras is the median.
  const double height = 1.5 + (tilt * Eigen::Vector3d::UnitZ()).dot(Eigen::Vector3d(-0.3, 0, 0));
  EXPECT_NEAR(ground->camera_height, height, 0.02);
  EXPECT_LT(AngleBetween(ground->up, tilt * Eigen::Vector3d::UnitZ()), 0.03);
}

TEST(Ground, IsNotInventedWhereThereIsNone) {
  EXPECT_FALSE(GroundOf(MapOverGround(Eigen::Quaterniond::Identity(), 0.0)).has_value());
  EXPECT_FALSE(GroundOf(Map()).has_value());
}

}  // namespace
}  // namespace orb360
