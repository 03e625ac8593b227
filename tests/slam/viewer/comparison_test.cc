#include "slam/viewer/comparison.h"

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::Field;

/// A bend of 200 poses, 0.1 s apart.
std::vector<StampedPose> Bend() {
  std::vector<StampedPose> poses(200);
  for (int i = 0; i < 200; ++i) {
    poses[i].timestamp = 0.1 * i;
    poses[i].world_from_camera.translation = {20 * std::sin(0.01 * i), 20 * std::cos(0.01 * i),
                                              0.002 * i};
  }
  return poses;
}

/// The same path in another world.
std::vector<StampedPose> Move(std::vector<StampedPose> poses, double scale) {
  const Similarity3 motion{
      scale,
      Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 3).normalized())),
      {100, -7, 3}};
  for (StampedPose& pose : poses) {
    pose.world_from_camera.translation = motion * pose.world_from_camera.translation;
  }
  return poses;
}

ComparedPath Other(std::vector<StampedPose> poses, bool has_metres) {
  return {.name = "other", .has_metres = has_metres, .poses = std::move(poses)};
}

TEST(ComparePaths, TwoPathsInMetresKeepTheirLengths) {
  const std::vector<StampedPose> run = Bend();
  const auto same = ComparePaths(run, true, Other(Move(run, 1), true));
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->is_rigid);
  EXPECT_THAT(same->errors, Each(Field(&Comparison::Error::distance, DoubleNear(0, 1e-9))));
  EXPECT_EQ(same->errors.size(), 200U);
  // One that is 2 % too long is wrong by that: the ends of a line of 20 s are off by a hundredth of
  // its length.
  const auto longer = ComparePaths(run, true, Other(Move(run, 1.02), true));
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->run_from_other.scale, 1);
  const double length =
      (run.front().world_from_camera.translation - run.back().world_from_camera.translation).norm();
  EXPECT_NEAR(longer->errors.front().distance, 0.01 * length, 0.2 * 0.01 * length);
  EXPECT_NEAR(longer->statistics.max, longer->errors.front().distance, 1e-6);
}

TEST(ComparePaths, AScaleIsFoundWhereOnePathHasNoMetres) {
  const std::vector<StampedPose> run = Bend();
  for (const bool is_run_metric : {true, false}) {
    const auto comparison =
        ComparePaths(run, is_run_metric, Other(Move(run, 0.25), !is_run_metric));
    ASSERT_TRUE(comparison);
    EXPECT_FALSE(comparison->is_rigid);
    EXPECT_TRUE(comparison->has_metres);
    EXPECT_NEAR(comparison->run_from_other.scale, 4, 1e-9);
    EXPECT_NEAR(comparison->statistics.max, 0, 1e-9);
  }
  EXPECT_FALSE(ComparePaths(run, false, Other(Move(run, 0.25), false))->has_metres);
}

TEST(ComparePaths, ErrorsAreInMetresOfThePathThatHasThem) {
  // The run has units of 4 m; the other path says where the camera was, once 1 m aside.
  std::vector<StampedPose> truth = Bend();
  const std::vector<StampedPose> run = Move(truth, 0.25);
  truth[100].world_from_camera.translation.z() += 1;
  const auto comparison = ComparePaths(run, false, Other(truth, true));
  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->errors[100].distance, 1, 0.05);
  EXPECT_LT(comparison->errors[10].distance, 0.05);
  EXPECT_NEAR(comparison->statistics.rmse, std::sqrt(1.0 / 200), 0.02);
}

TEST(ComparePaths, PathsWithoutTimesInCommonOrInOnePlaceAreNotCompared) {
  const std::vector<StampedPose> run = Bend();
  std::vector<StampedPose> later = run;
  for (StampedPose& pose : later) pose.timestamp += 0.05;
  EXPECT_FALSE(ComparePaths(run, true, Other(later, true)));
  std::vector<StampedPose> still = run;
  for (StampedPose& pose : still) pose.world_from_camera.translation = {1, 2, 3};
  EXPECT_FALSE(ComparePaths(run, true, Other(still, true)));
  EXPECT_FALSE(ComparePaths(still, false, Other(run, true)));
  EXPECT_FALSE(ComparePaths({}, true, Other(run, true)));
}

TEST(ComparisonJson, HasTheOtherPathInTheWorldOfTheRun) {
  const std::vector<StampedPose> run = Bend();
  const nlohmann::json json = ComparisonJson(*ComparePaths(run, true, Other(Move(run, 1), true)));
  EXPECT_EQ(json["name"], "other");
  EXPECT_EQ(json["isRigid"], true);
  EXPECT_EQ(json["unit"], "m");
  ASSERT_EQ(json["path"].size(), 600U);
  const Eigen::Vector3d& place = run[150].world_from_camera.translation;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(json["path"][450 + axis].get<double>(), place[axis], 1e-5);
  }
  EXPECT_EQ(json["time"].size(), json["error"].size());
  EXPECT_EQ(json["time"][150], 15.0);
}

TEST(ComparisonJson, ThinsALongPath) {
  std::vector<StampedPose> truth(50000);
  for (int i = 0; i < 50000; ++i) {
    truth[i].timestamp = 0.001 * i;
    truth[i].world_from_camera.translation = {0.01 * i, 1, 2};
  }
  const nlohmann::json json = ComparisonJson(*ComparePaths(truth, true, Other(truth, true)));
  EXPECT_LE(json["path"].size(), 3 * 20000U);
  EXPECT_GT(json["path"].size(), 3 * 15000U);
}

}  // namespace
}  // namespace orb360
