#include "slam/pipeline/first_steps.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "slam/pipeline/ground_steps.h"
#include "tests/slam/map/true_ground_step.h"
#include "tests/slam/pipeline/ground_drive.h"

namespace orb360 {
namespace {

TEST(AlignFirstKeyframes, MovesTheFirstKeyframesToWhereTheGroundSaysThatTheyWere) {
  Map map = Drive(6, 1.0, Scaled(Asphalt(12)));
  const KnownGround known{Eigen::Vector3d::UnitZ(), kHeight};
  for (const KeyframeId id : {3, 4, 5}) MeasureGroundSteps(id, known, {}, &map);
  // Two views of far landmarks have told that the camera stood almost still at first.
  for (const KeyframeId id : {0, 1}) {
    map.keyframe(id).world_from_camera.translation =
        TruePose(2).translation + Eigen::Vector3d(-0.03 * (2 - id), 0.01, 0);
  }
  AlignFirstKeyframes(known, {}, &map);
  for (const KeyframeId id : map.KeyframeIds()) {
    EXPECT_LT((map.PoseOf(id).translation - TruePose(id).translation).norm(), 0.03) << id;
  }
  EXPECT_EQ(map.keyframe(1).ground_steps.size(), 1u);
  EXPECT_EQ(map.keyframe(2).ground_steps.size(), 2u);
}

TEST(AlignFirstKeyframes, TakeTheNextStepWhereOneCannotBeMeasured) {
  Map map = Drive(6, 1.0, Scaled(Asphalt(12)));
  const KnownGround known{Eigen::Vector3d::UnitZ(), kHeight};
  for (const KeyframeId id : {2, 3, 4, 5}) MeasureGroundSteps(id, known, {}, &map);
  map.keyframe(2).ground_steps.resize(1);
  // The first image shows another ground, and tracking is wrong by a factor and sideways.
  map.keyframe(0).image =
      std::make_shared<const SpherePyramid>(LookAtGround(TruePose(0), Scaled(Asphalt(13))));
  map.keyframe(0).world_from_camera.translation =
      TruePose(1).translation + Eigen::Vector3d(-0.1, 0.3, 0);
  AlignFirstKeyframes(known, {}, &map);
  EXPECT_TRUE(map.keyframe(1).ground_steps.empty());
  EXPECT_LT((map.PoseOf(0).translation - TruePose(0).translation).norm(), 0.1 * kStep);
  // What is right by half is kept: the carrier may have braked.
  const Eigen::Vector3d slow = TruePose(1).translation - Eigen::Vector3d(0.7 * kStep, 0, 0);
  map.keyframe(0).world_from_camera.translation = slow;
  AlignFirstKeyframes(known, {}, &map);
  EXPECT_LT((map.PoseOf(0).translation - slow).norm(), 0.02);
}

TEST(AlignFirstKeyframes, TurnsThemAndTriangulatesWhatTheySeeAnew) {
  Map map = Drive(5, 1.0, Scaled(Asphalt(14)));
  for (const KeyframeId id : {1, 2, 3, 4}) {
    map.keyframe(id).ground_steps.push_back(
        TrueGroundStep(id - 1, TruePose(id - 1), TruePose(id), kHeight));
  }
  const std::vector<Eigen::Vector3d> points = {{4, 3, 1}, {6, -2, 2}, {2, 5, 3}, {9, 1, 4}};
  SeePoints(points, 0.7, &map);
  // Up to the third keyframe tracking has missed a turn of 3 degrees and half of the way.
  const Rigid3 pivot = TruePose(2);
  const Rigid3 wrong{ExpSo3({0, 0, 0.05}), Eigen::Vector3d::Zero()};
  for (const KeyframeId id : {0, 1}) {
    Rigid3& pose = map.keyframe(id).world_from_camera;
    const Eigen::Vector3d offset = wrong.rotation * (pose.translation - pivot.translation);
    pose = {wrong.rotation * pose.rotation, pivot.translation + 0.5 * offset};
  }
  AlignFirstKeyframes({Eigen::Vector3d::UnitZ(), kHeight}, {}, &map);
  for (KeyframeId id = 0; id < 5; ++id) {
    const Rigid3& pose = map.keyframe(id).world_from_camera;
    EXPECT_LT((pose.translation - TruePose(id).translation).norm(), 1e-6) << id;
    EXPECT_LT(pose.rotation.angularDistance(TruePose(id).rotation), 1e-6) << id;
  }
  ASSERT_EQ(map.num_landmarks(), static_cast<int>(points.size()));
  for (LandmarkId id = 0; id < 4; ++id) {
    EXPECT_LT((map.landmark(id).position - points[id]).norm(), 1e-4) << id;
    EXPECT_EQ(map.landmark(id).observations.size(), 5u) << id;
  }
  map.CheckConsistency();
}

TEST(AlignFirstKeyframes, LeavesAMapThatHoldsTogetherByItself) {
  const auto is_left = [](Map map) {
    for (KeyframeId id = 1; id < map.keyframe_end(); ++id) {
      map.keyframe(id).ground_steps.push_back(
          TrueGroundStep(id - 1, TruePose(id - 1), TruePose(id), kHeight));
    }
    const Eigen::Vector3d wrong = TruePose(0).translation + Eigen::Vector3d(0.5, 0, 0);
    map.keyframe(0).world_from_camera.translation = wrong;
    AlignFirstKeyframes({Eigen::Vector3d::UnitZ(), kHeight}, {}, &map);
    return map.PoseOf(0).translation == wrong;
  };
  const Ground plain = [](const Eigen::Vector2d&) { return 100.0; };
  EXPECT_FALSE(is_left(Drive(kGroundSearch, 1.0, plain)));
  EXPECT_TRUE(is_left(Drive(kGroundSearch + 1, 1.0, plain))) << "a grown map";
  Map continued = Drive(4, 1.0, plain);
  continued.keyframe(0).frame_index = -1;
  EXPECT_TRUE(is_left(std::move(continued))) << "a map of an earlier run";
}

}  // namespace
}  // namespace orb360
