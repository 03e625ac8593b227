#include "slam/pipeline/retriangulation.h"

#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/ground_drive.h"

namespace orb360 {
namespace {

Map DrivePast(std::span<const Eigen::Vector3d> points) {
  Map map;
  for (int i = 0; i < 3; ++i) {
    map.AddKeyframe(i, 0.1 * i, TruePose(i), std::make_shared<Features>());
  }
  SeePoints(points, 1.0, &map);
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
  // Without turns: what turns with the camera has a parallax.
  for (const KeyframeId id : {0, 1, 2}) {
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
