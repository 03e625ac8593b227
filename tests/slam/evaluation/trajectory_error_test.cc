#include "slam/evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFrameTime = 0.05;  // seconds
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

using Trajectory = std::vector<StampedPose>;

/// One turn of a horizontal circle, the camera looking ahead.
Trajectory Circle(int count, double radius) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    poses.push_back({kFrameTime * i,
                     {ExpSo3(kUp * (angle - kPi / 2)),
                      radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)}});
  }
  return poses;
}

/// Straight ahead (-X) in steps of `step` metres.
Trajectory Line(int count, double step) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({kFrameTime * i, {Eigen::Quaterniond::Identity(), {-step * i, 0, 0}}});
  }
  return poses;
}

Trajectory Moved(Trajectory poses, const Similarity3& moved_from_world) {
  for (StampedPose& pose : poses) {
    pose.world_from_camera = TransformPose(moved_from_world, pose.world_from_camera);
  }
  return poses;
}

TrajectoryErrors Evaluate(const Trajectory& truth, const Trajectory& estimate) {
  const auto errors = EvaluateTrajectory(PairPoses(truth, estimate, 0.01));
  if (!errors) throw std::runtime_error("no alignment");
  return *errors;
}

const Similarity3 kAnywhere{1.0, ExpSo3({0.3, -1.2, 2.0}), {40, -7, 12}};
const Similarity3 kSmaller{0.9, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};

TEST(TrajectoryError, TheSameTrajectoryHasNone) {
  const TrajectoryErrors errors = Evaluate(Circle(1000, 50), Circle(1000, 50));
  EXPECT_NEAR(errors.ate_se3.max, 0.0, 1e-9);
  EXPECT_NEAR(errors.ate_sim3.max, 0.0, 1e-9);
  EXPECT_NEAR(errors.truth_from_estimate.scale, 1.0, 1e-12);
  EXPECT_NEAR(errors.rpe.translation_percent, 0.0, 1e-9);
  EXPECT_NEAR(errors.rpe.rotation_deg_per_m, 0.0, 1e-9);
  EXPECT_NEAR(errors.rpe_frame.translation, 0.0, 1e-9);
  EXPECT_EQ(errors.position_errors.size(), 1000u);
}

TEST(TrajectoryError, TheWorldOfTheEstimateDoesNotMatter) {
  const TrajectoryErrors errors = Evaluate(Circle(1000, 50), Moved(Circle(1000, 50), kAnywhere));
  EXPECT_NEAR(errors.ate_se3.max, 0.0, 1e-9);
  EXPECT_NEAR(errors.rpe_raw.translation_percent, 0.0, 1e-9);
  EXPECT_NEAR(errors.rpe_raw.rotation_deg_per_m, 0.0, 1e-9);
  const Similarity3 back = errors.truth_from_estimate * kAnywhere;
  EXPECT_LT((back * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-9);
}

TEST(TrajectoryError, AScaledTrajectoryKeepsItsSim3ErrorAndTellsItsScale) {
  // The estimate is 4 times too small: SE(3) leaves 3/4 of each radius, pieces are 75 % short.
  const TrajectoryErrors errors =
      Evaluate(Circle(1000, 50), Moved(Circle(1000, 50), {0.25, ExpSo3({1, 2, 3}), {4, 5, 6}}));
  EXPECT_NEAR(errors.truth_from_estimate.scale, 4.0, 1e-9);
  EXPECT_NEAR(errors.ate_sim3.max, 0.0, 1e-9);
  EXPECT_NEAR(errors.ate_se3.rmse, 37.5, 1e-9);
  EXPECT_NEAR(errors.ate_se3.median, 37.5, 1e-9);
  EXPECT_NEAR(errors.rpe.translation_percent, 0.0, 1e-9);
  // Chord over arc: 100 m of a circle of 50 m are an angle of 2, the chord 100 sin(1). The piece
  // ends at the first pose beyond, within one step of 0.3 m.
  EXPECT_NEAR(errors.rpe_raw.translation_percent, 75.0 * std::sin(1.0), 0.2);
  EXPECT_NEAR(errors.rpe_raw.rotation_deg_per_m, 0.0, 1e-9);
}

TEST(TrajectoryError, AlternatingHeightIsTheAbsoluteErrorInClosedForm) {
  // Heights that alternate between +d and -d are uncorrelated with a circle's x and y, so the
  // rigid alignment stays the identity; the scale shrinks to r^2 / (r^2 + d^2).
  const double r = 50.0;
  const double d = 0.4;
  Trajectory estimate = Circle(1000, r);
  for (size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation.z() = i % 2 == 0 ? d : -d;
  }
  const TrajectoryErrors errors = Evaluate(Circle(1000, r), Moved(estimate, kAnywhere));
  EXPECT_NEAR(errors.ate_se3.rmse, d, 1e-9);
  EXPECT_NEAR(errors.ate_se3.mean, d, 1e-9);
  EXPECT_NEAR(errors.ate_se3.max, d, 1e-9);
  // From frame to frame the height is wrong by 2 d, the rest by next to nothing.
  EXPECT_NEAR(errors.rpe_frame.translation, 2.0 * d, 1e-4);
  const double scale = r * r / (r * r + d * d);
  EXPECT_NEAR(errors.truth_from_estimate.scale, scale, 1e-9);
  EXPECT_NEAR(errors.ate_sim3.rmse, std::sqrt(r * r * d * d / (r * r + d * d)), 1e-9);
}

TEST(TrajectoryError, AHeadingDriftIsTheRelativeErrorInClosedForm) {
  // The camera's heading drifts by 0.02 degrees a metre on a straight path whose positions are
  // right: the relative rotation has just that error.
  Trajectory estimate = Line(3001, 0.1);
  for (size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.rotation =
        ExpSo3(kUp * (0.02 * kPi / 180.0) * (0.1 * static_cast<double>(i)));
  }
  const TrajectoryErrors errors = Evaluate(Line(3001, 0.1), estimate);
  EXPECT_EQ(errors.rpe.piece_length, 100.0);
  EXPECT_EQ(errors.rpe.pieces, 201u);  // Starts at 0, 1, ... 200 m.
  EXPECT_NEAR(errors.rpe.rotation_deg_per_m, 0.02, 1e-6);
  EXPECT_NEAR(errors.rpe_frame.rotation_deg, 0.002, 1e-9);
  // The path is seen at angles from 0 to 4 degrees against its true direction: the piece that
  // starts at s is off by a chord of 2 L sin(angle / 2) with the angle 0.02 s.
  double sum = 0.0;
  for (int s = 0; s <= 200; ++s) sum += 200.0 * std::sin(0.5 * 0.02 * s * kPi / 180.0);
  EXPECT_NEAR(errors.rpe.translation_percent, sum / 201.0, 1e-6);
  EXPECT_NEAR(errors.ate_se3.max, 0.0, 1e-9);
}

TEST(TrajectoryError, AReversedListIsTheSameTrajectory) {
  Trajectory estimate = Circle(1000, 50);
  std::ranges::reverse(estimate);
  EXPECT_NEAR(Evaluate(Circle(1000, 50), estimate).ate_se3.max, 0.0, 1e-9);
}

TEST(TrajectoryError, ATrajectoryReversedInTimeIsWrongInEveryMotion) {
  // Backward on a straight line: turned around, the positions fit; the camera went the other way,
  // an error of twice the way.
  Trajectory estimate = Line(3001, 0.1);
  for (size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation.x() *= -1.0;
  }
  const TrajectoryErrors errors = Evaluate(Line(3001, 0.1), estimate);
  EXPECT_NEAR(errors.ate_se3.max, 0.0, 1e-6);
  EXPECT_NEAR(errors.rpe.translation_percent, 200.0, 1e-6);
  EXPECT_NEAR(errors.rpe_raw.translation_percent, 200.0, 1e-6);
  EXPECT_NEAR(errors.rpe.rotation_deg_per_m, 0.0, 1e-9);
}

TEST(TrajectoryError, AConstantTimeShiftOfOneFrameIsAConstantWayAlongThePath) {
  // Paired with poses one frame later: on a circle that is a turn about the centre, which the
  // alignment undoes; on a path with uneven speed the difference stays.
  Trajectory shifted = Circle(1000, 50);
  for (StampedPose& pose : shifted) pose.timestamp -= kFrameTime;
  const std::vector<PosePair> pairs = PairPoses(Circle(1000, 50), shifted, 0.01);
  EXPECT_EQ(pairs.size(), 999u);
  EXPECT_NEAR(EvaluateTrajectory(pairs)->ate_se3.max, 0.0, 1e-9);

  // x = t^2: the shifted positions differ by 2 t dt + dt^2, uniformly spread over t; without their
  // mean, dt * (2 t - 1) on t in [0, 1] has the RMS dt / sqrt(3).
  constexpr int kCount = 2001;
  constexpr double kShift = 0.01;  // 20 frames
  Trajectory truth;
  for (int i = 0; i < kCount; ++i) {
    const double t = i / 2000.0;
    truth.push_back({t, {Eigen::Quaterniond::Identity(), {t * t, 0, 0}}});
  }
  Trajectory late = truth;
  for (StampedPose& pose : late) {
    pose.world_from_camera.translation.x() = std::pow(pose.timestamp + kShift, 2);
  }
  EXPECT_NEAR(EvaluateTrajectory(PairPoses(truth, late, 1e-4))->ate_se3.rmse,
              kShift / std::sqrt(3.0), 1e-5);
}

TEST(TrajectoryError, ATimeShiftBeyondTheLimitLeavesNoPairs) {
  Trajectory shifted = Circle(100, 50);
  for (StampedPose& pose : shifted) pose.timestamp += 0.02;
  EXPECT_TRUE(PairPoses(Circle(100, 50), shifted, 0.01).empty());
  EXPECT_EQ(PairPoses(Circle(100, 50), shifted, 0.0201).size(), 100u);
}

TEST(TrajectoryError, PiecesShrinkOnShortPaths) {
  const TrajectoryErrors errors = Evaluate(Line(31, 1.0), Moved(Line(31, 1.0), kSmaller));
  EXPECT_NEAR(errors.rpe.piece_length, 15.0, 1e-12);
  EXPECT_EQ(errors.rpe.pieces, 16u);  // Every pose from 0 to 15 m starts one.
  EXPECT_NEAR(errors.rpe_raw.translation_percent, 10.0, 1e-9);
  EXPECT_NEAR(errors.rpe.translation_percent, 0.0, 1e-9);
}

TEST(TrajectoryError, WhatDoesNotMoveCannotBeAligned) {
  const Trajectory still(10, StampedPose{});
  EXPECT_FALSE(EvaluateTrajectory({}));
  EXPECT_FALSE(EvaluateTrajectory(PairPoses(Line(2, 1.0), Line(2, 1.0), 0.01)));
  Trajectory standing = Line(10, 1.0);
  for (StampedPose& pose : standing) pose.world_from_camera.translation.setZero();
  EXPECT_FALSE(EvaluateTrajectory(PairPoses(Line(10, 1.0), standing, 0.01)));
  EXPECT_FALSE(EvaluateTrajectory(PairPoses(standing, Line(10, 1.0), 0.01)));
}

TEST(Summarize, AgreesWithHandComputedValues) {
  const ErrorStatistics odd = Summarize(std::vector<double>{3.0, 0.0, 4.0});
  EXPECT_NEAR(odd.rmse, std::sqrt(25.0 / 3.0), 1e-12);
  EXPECT_NEAR(odd.mean, 7.0 / 3.0, 1e-12);
  EXPECT_EQ(odd.median, 3.0);
  EXPECT_EQ(odd.max, 4.0);
  EXPECT_EQ(Summarize(std::vector<double>{1.0, 2.0, 5.0, 9.0}).median, 3.5);
  EXPECT_THROW(Summarize({}), ContractError);
}

}  // namespace
}  // namespace orb360
