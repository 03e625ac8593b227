#include "slam/pipeline/ground_steps.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "slam/geometry/bearing.h"
#include "tests/slam/map/true_ground_step.h"
#include "tests/slam/pipeline/ground_drive.h"

namespace orb360 {
namespace {

TEST(MeasureGroundSteps, MeasuresFromTheLastTwoKeyframes) {
  Map map = Drive(4, 0.3, Scaled(Asphalt(1)));
  MeasureGroundSteps(3, std::nullopt, {}, &map);
  const std::vector<GroundStepFrom>& steps = map.keyframe(3).ground_steps;
  ASSERT_EQ(steps.size(), 2u);
  for (const int gap : {1, 2}) {
    const GroundStepFrom& step = steps[static_cast<size_t>(gap) - 1];
    EXPECT_EQ(step.keyframe, 3 - gap);
    EXPECT_NEAR(std::log(step.ratio / (gap * kStep / kHeight)), 0.0, 0.005) << gap;
    // Both cameras see one point of the ground.
    const Eigen::Vector3d seen1 = TruePose(3 - gap) * (kHeight * step.point1);
    const Eigen::Vector3d seen2 = TruePose(3) * (kHeight * step.point2);
    EXPECT_LT((seen1 - seen2).norm(), 0.01) << gap;
    EXPECT_NEAR(seen1.z(), 0.0, 0.01) << gap;
    const Eigen::Vector3d direction = TruePose(3).rotation * step.direction2;
    EXPECT_LT(AngleBetween(direction, Eigen::Vector3d::UnitX()), 0.01) << gap;
    EXPECT_LT(AngleBetween(TruePose(3 - gap).rotation * step.direction1, direction), 0.003) << gap;
    const Eigen::Vector3d up = TruePose(3).rotation * step.up;
    EXPECT_LT(std::acos(up.z()), 0.02) << gap;
  }
}

TEST(MeasureGroundSteps, TellsTheRotationThatTrackingHasMissed) {
  Map map = Drive(2, 1.0, Scaled(Asphalt(11)));
  Eigen::Quaterniond& tracked = map.keyframe(1).world_from_camera.rotation;
  tracked = ExpSo3({0, 0, 0.02}) * tracked;
  MeasureGroundSteps(1, std::nullopt, {}, &map);
  ASSERT_EQ(map.keyframe(1).ground_steps.size(), 1u);
  const GroundStepFrom& step = map.keyframe(1).ground_steps.front();
  EXPECT_LT(
      AngleBetween(TruePose(0).rotation * step.direction1, TruePose(1).rotation * step.direction2),
      0.003);
}

TEST(MeasureGroundSteps, KeepsTheTrackedRotationOverBoards) {
  // The grain of boards across the motion is nearly the same all along them.
  const Asphalt grain(13);
  const Asphalt dirt(14);
  const Ground boards = [&](const Eigen::Vector2d& p) {
    return grain({p.x() / kHeight, 0.02 * p.y()}) + 0.05 * dirt(p / kHeight);
  };
  Map map = Drive(2, 1.0, boards);
  MeasureGroundSteps(1, std::nullopt, {}, &map);
  for (const GroundStepFrom& step : map.keyframe(1).ground_steps) {
    EXPECT_GT(step.turn_sigma, 0.01);
    EXPECT_LT(AngleBetween(TruePose(0).rotation * step.direction1,
                           TruePose(1).rotation * step.direction2),
              1e-6);
  }
  EXPECT_EQ(map.keyframe(1).ground_steps.size(), 1u);
}

TEST(MeasureGroundSteps, SeeksTheStepAroundTheLastSpeedAsFarAsACarAccelerates) {
  struct Case {
    double last_ratio;  // of the last step, relative to the true one
    double period;      // between keyframes, s
    bool is_measured;
  };
  for (const auto& [last_ratio, period, is_measured] :
       {Case{0.9, 0.1, true}, Case{0.3, 0.1, false}, Case{0.3, 0.5, true}, Case{2.5, 0.1, false},
        Case{2.5, 0.8, true}}) {
    Map map = Drive(3, 1.0, Scaled(Asphalt(7)));
    for (const KeyframeId id : {0, 1, 2}) map.keyframe(id).timestamp = period * id;
    map.keyframe(1).ground_steps.push_back({.keyframe = 0,
                                            .ratio = last_ratio * kStep / kHeight,
                                            .sigma = 0.002,
                                            .direction2 = Eigen::Vector3d(-1, 0, 0)});
    MeasureGroundSteps(2, std::nullopt, {}, &map);
    const std::vector<GroundStepFrom>& steps = map.keyframe(2).ground_steps;
    EXPECT_EQ(!steps.empty() && steps.front().keyframe == 1, is_measured)
        << last_ratio << " of the step in " << period << " s";
  }
}

// A drive whose camera is tilted against the ground, rad.
Map TiltedDrive(double tilt) {
  Map map;
  for (int i = 0; i < 3; ++i) {
    Rigid3 pose = TruePose(i);
    pose.rotation = pose.rotation * ExpSo3({0, tilt, 0});
    const auto image =
        std::make_shared<const SpherePyramid>(LookAtGround(pose, Scaled(Asphalt(17))));
    map.AddKeyframe(i, 0.1 * i, pose, std::make_shared<Features>());
    map.keyframe(i).image = image;
  }
  return map;
}

TEST(MeasureGroundSteps, OnASlopeTheHeightIsUncertainByTheCosineOfItsAngle) {
  constexpr double kTilt = 0.35;
  const KnownGround ground{Eigen::Vector3d::UnitZ(), kHeight};
  Map alike = TiltedDrive(kTilt);
  Map slope = alike;
  for (Map* map : {&alike, &slope}) {
    MeasureGroundSteps(1, ground, {}, map);
    ASSERT_EQ(map->keyframe(1).ground_steps.size(), 1u);
  }
  // A camera that is always tilted alike is on level ground; one that was upright before is not.
  slope.keyframe(1).ground_steps.front().up = Eigen::Vector3d::UnitZ();
  for (Map* map : {&alike, &slope}) {
    MeasureGroundSteps(2, ground, {}, map);
    ASSERT_FALSE(map->keyframe(2).ground_steps.empty());
  }
  const double sigma = alike.keyframe(2).ground_steps.front().sigma;
  EXPECT_LT(sigma, 0.015);
  EXPECT_NEAR(slope.keyframe(2).ground_steps.front().sigma,
              std::hypot(sigma, 0.99 - std::cos(kTilt)), 0.015);
}

TEST(MeasureGroundSteps, MeasuresNothingWithoutAnImage) {
  Map map = Drive(2, 1.0, Scaled(Asphalt(2)));
  map.keyframe(0).image = nullptr;
  MeasureGroundSteps(1, std::nullopt, {}, &map);
  EXPECT_TRUE(map.keyframe(1).ground_steps.empty());
}

TEST(CorrectStep, GivesAStepTheLengthThatTheGroundShows) {
  Map map = Drive(2, 1.0, Scaled(Asphalt(3)));
  Eigen::Vector3d& to = map.keyframe(1).world_from_camera.translation;
  const Eigen::Vector3d from = map.keyframe(0).world_from_camera.translation;
  const KnownGround ground{Eigen::Vector3d::UnitZ(), kHeight};
  MeasureGroundSteps(1, ground, {}, &map);
  const Eigen::Vector3d truth = to;
  to = from + 0.2 * (truth - from);
  CorrectStep(1, ground, &map);
  EXPECT_LT((to - truth).norm(), 0.01);
  // A step that agrees stays as tracking has found it.
  const Eigen::Vector3d tracked = from + 1.01 * (truth - from);
  to = tracked;
  CorrectStep(1, ground, &map);
  EXPECT_EQ(to, tracked);
}

TEST(CorrectStep, RemovesWhatMovesWithTheCamera) {
  const Ground ground = Scaled(Asphalt(6));
  const Eigen::Vector3d wall(3.0, 4.0, 1.0);
  const Eigen::Vector3d car = TruePose(0) * Eigen::Vector3d(0.5, 3.0, -0.5);
  Map map;
  for (int i = 0; i < 2; ++i) {
    auto features = std::make_shared<Features>();
    // The car is in the same place beside both cameras.
    for (const Eigen::Vector3d& seen :
         {Eigen::Vector3d(TruePose(i).Inverse() * wall), Eigen::Vector3d(0.5, 3.0, -0.5)}) {
      features->keypoints.push_back({Eigen::Vector2f::Zero(), 0.0F, 0.004F, 0, 50});
      features->bearings.push_back(seen.normalized());
      features->descriptors.push_back({});
    }
    const KeyframeId id = map.AddKeyframe(i, 0.1 * i, TruePose(i), features);
    map.keyframe(id).image =
        std::make_shared<const SpherePyramid>(LookAtGround(TruePose(i), ground));
  }
  const LandmarkId on_wall = map.AddLandmark(wall, {});
  const LandmarkId on_car = map.AddLandmark(car, {});
  for (const KeyframeId id : {0, 1}) {
    map.AddObservation(on_wall, id, 0);
    map.AddObservation(on_car, id, 1);
  }
  // By the car, the camera stands still and does not turn.
  Rigid3& pose = map.keyframe(1).world_from_camera;
  pose.translation = TruePose(0).translation + Eigen::Vector3d(0.05, 0, 0);
  pose.rotation = ExpSo3({0, 0, -0.05}) * TruePose(1).rotation;
  const KnownGround known{Eigen::Vector3d::UnitZ(), kHeight};
  MeasureGroundSteps(1, known, {}, &map);
  // Tracking lets expect a step that is too short to be measured.
  ASSERT_TRUE(map.keyframe(1).ground_steps.empty());
  map.keyframe(1).ground_steps.push_back(TrueGroundStep(0, TruePose(0), TruePose(1), kHeight));
  CorrectStep(1, known, &map);
  EXPECT_LT((pose.translation - TruePose(1).translation).norm(), 0.01);
  EXPECT_LT(pose.rotation.angularDistance(TruePose(1).rotation), 1e-3);
  EXPECT_TRUE(map.HasLandmark(on_wall));
  EXPECT_FALSE(map.HasLandmark(on_car));
  map.CheckConsistency();
}

TEST(MeasureGroundSteps, FindsAStepInAnotherDirectionThanTrackedWhileNoGroundIsKnown) {
  Map map = Drive(2, 1.0, Scaled(Asphalt(9)));
  // With few landmarks nearby, tracking is off by 30 degrees.
  Eigen::Vector3d& to = map.keyframe(1).world_from_camera.translation;
  const Eigen::Vector3d from = map.keyframe(0).world_from_camera.translation;
  const Eigen::Vector3d truth = to;
  to = from + ExpSo3({0, 0, 0.5}) * (truth - from);
  MeasureGroundSteps(1, std::nullopt, {}, &map);
  ASSERT_EQ(map.keyframe(1).ground_steps.size(), 1u);
  const GroundStepFrom& step = map.keyframe(1).ground_steps.front();
  EXPECT_NEAR(step.ratio, kStep / kHeight, 0.01);
  EXPECT_LT(
      AngleBetween(map.keyframe(1).world_from_camera.rotation * step.direction2, truth - from),
      0.03);
}

TEST(MeasureGroundSteps, DropsTheLongerStepWhereItContradictsTheSumOfTheOthers) {
  Map map = Drive(3, 1.0, Scaled(Asphalt(6)));
  MeasureGroundSteps(1, std::nullopt, {}, &map);
  MeasureGroundSteps(2, std::nullopt, {}, &map);
  ASSERT_EQ(map.keyframe(2).ground_steps.size(), 2u);
  EXPECT_LT(MisclosureOfSteps(map, 2).value(), 0.02);
  map.keyframe(2).ground_steps.clear();
  map.keyframe(1).ground_steps.front().ratio *= 1.5;  // as if on a repeated texture
  MeasureGroundSteps(2, std::nullopt, {}, &map);
  ASSERT_EQ(map.keyframe(2).ground_steps.size(), 1u);
  EXPECT_EQ(map.keyframe(2).ground_steps.front().keyframe, 1);
  EXPECT_FALSE(MisclosureOfSteps(map, 2));
}

}  // namespace
}  // namespace orb360
