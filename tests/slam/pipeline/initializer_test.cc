#include "slam/pipeline/initializer.h"

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

TEST(Initializer, RecoversMotionAndPointsUpToScale) {
  SyntheticScene scene(500);
  const Rigid3 pose2{ExpSo3({0.05, -0.1, 0.2}), {-0.9, 0.2, 0.1}};
  const InitializationResult result =
      InitializeFromTwoViews(*scene.See(Rigid3()), *scene.See(pose2), {});
  ASSERT_TRUE(result.map.has_value());
  const Rigid3& found = result.map->world_from_camera2;
  EXPECT_LT(found.rotation.angularDistance(pose2.rotation), 1e-3);
  EXPECT_LT(AngleBetween(found.translation, pose2.translation), 5e-3);
  const double scale = pose2.translation.norm() / found.translation.norm();
  int near = 0;
  for (const TwoViewMap::Point& point : result.map->points) {
    EXPECT_EQ(point.feature1, point.feature2);
    const Eigen::Vector3d truth = scene.points[point.feature1].position;
    near += (scale * point.position - truth).norm() < 0.1 * truth.norm();
  }
  EXPECT_GT(near, 0.85 * static_cast<double>(result.map->points.size()));
}

TEST(Initializer, WaitsWhenTheCameraOnlyTurns) {
  SyntheticScene scene(500);
  const Rigid3 turned{ExpSo3({0.1, 0.2, 0.15}), {0.0, 0.0, 0.0}};
  const InitializationResult result =
      InitializeFromTwoViews(*scene.See(Rigid3()), *scene.See(turned), {});
  EXPECT_FALSE(result.map.has_value());
  EXPECT_EQ(result.failure, InitializationFailure::kLittleParallax);
  ASSERT_TRUE(result.turn.has_value());
  EXPECT_LT(result.turn->angularDistance(turned.rotation), 1e-3);
}

TEST(Initializer, StartsUnderASkyThatHoldsMostOfTheFeatures) {
  SyntheticScene scene(500);
  for (size_t i = 0; i < 320; ++i) {
    Eigen::Vector3d& position = scene.points[i].position;
    position *= 1e6 / position.norm();
  }
  const Rigid3 pose2{ExpSo3({0.05, -0.1, 0.2}), {-0.9, 0.2, 0.1}};
  const InitializationResult result =
      InitializeFromTwoViews(*scene.See(Rigid3()), *scene.See(pose2), {});
  ASSERT_TRUE(result.map.has_value());
  EXPECT_LT(AngleBetween(result.map->world_from_camera2.translation, pose2.translation), 5e-3);
  for (const TwoViewMap::Point& point : result.map->points) EXPECT_GE(point.feature1, 320);
}

TEST(Initializer, FindsMatchesAfterAHalfTurn) {
  SyntheticScene scene(500);
  const Rigid3 pose2{ExpSo3({0.0, 0.0, 3.0}), {-0.9, 0.2, 0.1}};
  const InitializationResult result =
      InitializeFromTwoViews(*scene.See(Rigid3()), *scene.See(pose2), {});
  ASSERT_TRUE(result.map.has_value());
  EXPECT_LT(result.map->world_from_camera2.rotation.angularDistance(pose2.rotation), 1e-3);
}

TEST(Initializer, AsksForAnotherReferenceWhenTheViewsShareNothing) {
  SyntheticScene here(300);
  SyntheticScene there(600);
  there.points.erase(there.points.begin(), there.points.begin() + 300);  // other descriptors
  const InitializationResult result =
      InitializeFromTwoViews(*here.See(Rigid3()), *there.See(Rigid3()), {});
  EXPECT_FALSE(result.map.has_value());
  EXPECT_EQ(result.failure, InitializationFailure::kFewMatches);
}

}  // namespace
}  // namespace orb360
