#include "slam/pipeline/retriangulation.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/ground_drive.h"

namespace orb360 {
namespace {

/// Three keyframes of a drive that see the same points of the world, each a landmark in its place.
Map DrivePast(std::span<const Eigen::Vector3d> points) {
  Map map;
  for (int i = 0; i < 3; ++i) {
    auto features = std::make_shared<Features>();
    for (const Eigen::Vector3d& point : points) {
      features->bearings.push_back((TruePose(i).Inverse() * point).normalized());
      features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0F, 0.004F, 0, 50});
      features->descriptors.emplace_back();
    }
    map.AddKeyframe(i, 0.1 * i, TruePose(i), features);
  }
  for (size_t p = 0; p < points.size(); ++p) {
    const LandmarkId id = map.AddLandmark(points[p], Color{});
    for (const KeyframeId keyframe : {0, 1, 2}) {
      map.AddObservation(id, keyframe, static_cast<int>(p));
    }
  }
  return map;
}

const Eigen::Vector3d kWall(4, 3, 1);

TEST(Retriangulate, MovesALandmarkThatWasMadeWithWrongPoses) {
  Map map = DrivePast(std::vector{kWall});
  map.landmark(0).position = 0.5 * kWall;
  Retriangulate(0, &map);
  ASSERT_TRUE(map.HasLandmark(0));
  EXPECT_LT((map.landmark(0).position - kWall).norm(), 1e-6);
  EXPECT_EQ(map.landmark(0).observations.size(), 3u);
}

TEST(Retriangulate, LeavesALandmarkThatAgreesWithItsObservations) {
  Map map = DrivePast(std::vector{kWall});
  const Eigen::Vector3d adjusted = kWall + Eigen::Vector3d(0.01, 0.01, 0);
  map.landmark(0).position = adjusted;
  Retriangulate(0, &map);
  EXPECT_EQ(map.landmark(0).position, adjusted);
}

TEST(Retriangulate, RemovesWhatMovesWithTheCamera) {
  Map map = DrivePast(std::vector{kWall});
  auto features = std::make_shared<Features>(*map.keyframe(0).features);
  for (const KeyframeId id : {0, 1, 2}) map.keyframe(id).features = features;
  for (const KeyframeId id : {0, 1, 2}) {  // turns alone would look like motion
    map.keyframe(id).world_from_camera.rotation = TruePose(0).rotation;
  }
  Retriangulate(0, &map);
  EXPECT_FALSE(map.HasLandmark(0));
  map.CheckConsistency();
}

TEST(Retriangulate, RemovesALandmarkOfWhichOneObservationIsOfSomethingElse) {
  Map map = DrivePast(std::vector{kWall, Eigen::Vector3d(4, 3, 1.3)});
  map.RemoveObservation(0, 1);
  map.RemoveObservation(1, 1);
  map.AddObservation(0, 1, 1);  // higher up, where no depth of the landmark could bring it
  Retriangulate(0, &map);
  EXPECT_FALSE(map.HasLandmark(0));
  EXPECT_TRUE(map.HasLandmark(1));
  map.CheckConsistency();
}

}  // namespace
}  // namespace orb360
