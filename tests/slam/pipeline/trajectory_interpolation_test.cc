#include "slam/pipeline/trajectory_interpolation.h"

#include <memory>

#include <gtest/gtest.h>

#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kPeriod = 0.3;  // s
constexpr double kRadius = 20.0;
constexpr double kTurn = 0.05;  // rad from keyframe to keyframe: a step of 1 m

Rigid3 OnArc(double timestamp) {
  const Eigen::Quaterniond yaw = ExpSo3(Eigen::Vector3d(0, 0, kTurn * timestamp / kPeriod));
  return {yaw, yaw * Eigen::Vector3d(0, -kRadius, 0)};
}

// Eight keyframes on an arc; every second one is `shake` too high.
Map Drive(double shake) {
  Map map;
  for (int i = 0; i < 8; ++i) {
    Rigid3 pose = OnArc(i * kPeriod);
    pose.translation.z() += i % 2 * shake;
    map.AddKeyframe(10 * i, i * kPeriod, pose, std::make_shared<Features>());
  }
  return map;
}

double SigmaOf(const PositionPrior& prior) { return 1 / prior.sqrt_information(0, 0); }

TEST(TrajectoryInterpolation, FollowsAnArc) {
  const TrajectoryInterpolation path(Drive(0));
  for (const double timestamp : {0.1, 1.0, 1.05, 2.0}) {
    const PositionPrior prior = path.PositionAt(timestamp).value();
    // Its radius tells the step to a fraction of a millimetre, so that the least sigma is left.
    EXPECT_LT((prior.position - OnArc(timestamp).translation).norm(), 1e-3) << timestamp;
    EXPECT_NEAR(SigmaOf(prior), 0.005, 1e-4) << timestamp;
  }
}

TEST(TrajectoryInterpolation, IsAsUncertainAsTheKeyframesShake) {
  constexpr double kShake = 0.04;
  const TrajectoryInterpolation path(Drive(kShake));
  EXPECT_NEAR(SigmaOf(path.PositionAt(3.5 * kPeriod).value()), kShake, 0.003);
  EXPECT_LT(SigmaOf(path.PositionAt(3.02 * kPeriod).value()), 0.4 * kShake) << "near a keyframe";
}

TEST(TrajectoryInterpolation, TellsNothingWhereTheVideoIsCut) {
  Map map = Drive(0);
  // 1 m from keyframe to keyframe, and 15 m from the fourth to the fifth.
  for (KeyframeId id = 4; id < 8; ++id) {
    map.keyframe(id).world_from_camera.translation += Eigen::Vector3d(0, 15, 0);
  }
  const TrajectoryInterpolation path(map);
  EXPECT_FALSE(path.PositionAt(3.5 * kPeriod));
  EXPECT_TRUE(path.PositionAt(2.5 * kPeriod));
  // The cut does not count as motion that is not smooth.
  EXPECT_NEAR(SigmaOf(path.PositionAt(4.5 * kPeriod).value()), 0.005, 1e-4);
}

TEST(TrajectoryInterpolation, TellsNothingWhereNoKeyframesAreNear) {
  const TrajectoryInterpolation path(Drive(0));
  EXPECT_FALSE(path.PositionAt(-0.1));
  EXPECT_FALSE(path.PositionAt(2.2));
  Map map = Drive(0);
  for (const KeyframeId id : {2, 3, 4}) map.RemoveKeyframe(id, 1);
  EXPECT_FALSE(TrajectoryInterpolation(map).PositionAt(3 * kPeriod)) << "a gap of 1.2 s";
  EXPECT_FALSE(TrajectoryInterpolation(Map()).PositionAt(0.1));
}

TEST(TrajectoryInterpolation, LeavesOutKeyframesOfAnEarlierRunWhoseClockIsAnother) {
  Map map = Drive(0);
  for (int i = 0; i < 8; ++i) {  // elsewhere at the same times
    map.AddKeyframe(i - 8, (i + 0.5) * kPeriod, {Eigen::Quaterniond::Identity(), {50, 50, 1.0 * i}},
                    std::make_shared<Features>());
  }
  const PositionPrior prior = TrajectoryInterpolation(map).PositionAt(1.0).value();
  EXPECT_LT((prior.position - OnArc(1.0).translation).norm(), 1e-3);
}

TEST(TrajectoryInterpolation, TellsNothingBetweenEqualTimes) {
  Map map;
  for (int i = 0; i < 6; ++i) {
    map.AddKeyframe(i, 1.0, OnArc(i * kPeriod), std::make_shared<Features>());
  }
  EXPECT_FALSE(TrajectoryInterpolation(map).PositionAt(1.0));
}

}  // namespace
}  // namespace orb360
