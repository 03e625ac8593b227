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

TEST(Ground, ALandmarkFarBelowItIsRemoved) {
  SyntheticScene scene(4, 2.0, 8.0);
  // Camera at the origin, ground at -1.5.
  const std::vector<Eigen::Vector3d> places = {
      {-5.0, 0.0, -1.5},     // on the ground
      {-60.0, 0.0, -8.0},    // a valley
      {-40.0, 0.0, -12.0},   // the lower part of a car on the next lane, without parallax
      {-400.0, 0.0, -60.0},  // the same, with less parallax
  };
  for (size_t i = 0; i < places.size(); ++i) scene.points[i].position = places[i];
  Map map = scene.MakeMap(Walk(2, {-0.1, 0.0, 0.0}), 4);
  const std::vector<LandmarkId> landmarks = map.keyframe(0).landmarks;
  ASSERT_EQ(landmarks.size(), 4u);
  RemoveBelowGround(0, {.up = Eigen::Vector3d::UnitZ(), .camera_height = 1.5}, &map);
  for (const LandmarkId id : landmarks) {
    const bool is_kept = id != kNoId && map.HasLandmark(id);
    if (is_kept) {
      EXPECT_GT(map.landmark(id).position.z(), -10);
    }
  }
  EXPECT_EQ(map.num_landmarks(), 2);
  map.CheckConsistency();
}

}  // namespace
}  // namespace orb360
