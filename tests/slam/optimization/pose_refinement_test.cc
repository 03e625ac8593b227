#include "slam/optimization/pose_refinement.h"

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

std::vector<PoseObservation> Observe(const Rigid3& pose, int count, double sigma, double wrong,
                                     RandomGeometry* random) {
  std::vector<PoseObservation> observations;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d local = random->Point(2.0, 20.0);
    const bool is_wrong = i < wrong * count;
    observations.push_back({pose * local,
                            is_wrong ? random->Bearing() : random->Noisy(local.normalized(), sigma),
                            std::max(sigma, 1e-4)});
  }
  return observations;
}

Rigid3 Disturb(const Rigid3& pose, RandomGeometry* random) {
  return pose * Rigid3{random->Rotation(0.1), random->Point(0.1, 0.4)};
}

TEST(PoseRefinement, IsExactWithoutNoise) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = random.Transform();
    const RefinedPose found =
        RefinePose(Disturb(truth, &random), Observe(truth, 100, 0.0, 0.0, &random));
    EXPECT_EQ(found.num_inliers, 100);
    EXPECT_LT(found.world_from_camera.rotation.angularDistance(truth.rotation), 1e-7);
    EXPECT_LT((found.world_from_camera.translation - truth.translation).norm(), 1e-7);
  }
}

TEST(PoseRefinement, NoiseLeavesTheErrorItMust) {
  RandomGeometry random(2);
  constexpr double kSigma = 0.003;
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = random.Transform();
    const RefinedPose found =
        RefinePose(Disturb(truth, &random), Observe(truth, 400, kSigma, 0.0, &random));
    EXPECT_GT(found.num_inliers, 360);  // 95 % in the mean
    EXPECT_NEAR(found.rms, 0.93, 0.1);  // of a chi-squared law cut at 95 %
    // 400 bearings all around to points 2 to 20 away: five standard deviations.
    EXPECT_LT(found.world_from_camera.rotation.angularDistance(truth.rotation),
              5 * kSigma * std::sqrt(3.0 / 800));
    EXPECT_LT((found.world_from_camera.translation - truth.translation).norm(),
              5 * kSigma * 11.0 * std::sqrt(3.0 / 400));
  }
}

TEST(PoseRefinement, SetsAsideThirtyPercentOfWrongMatches) {
  RandomGeometry random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = random.Transform();
    const RefinedPose found =
        RefinePose(Disturb(truth, &random), Observe(truth, 300, 0.002, 0.3, &random));
    EXPECT_LT(found.world_from_camera.rotation.angularDistance(truth.rotation), 1.5e-3);
    EXPECT_LT((found.world_from_camera.translation - truth.translation).norm(), 0.02);
    int wrong = 0;
    for (int i = 0; i < 90; ++i) wrong += found.inliers[i];
    EXPECT_LT(wrong, 3);
  }
}

// The corners of something that moves with the camera outnumber those of the surroundings, and lie
// together.
TEST(PoseRefinement, SurroundingsPrevailOverAnObjectWithMoreCorners) {
  RandomGeometry random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = random.Transform();
    // What the object takes to be the camera's pose: it has not turned by one degree.
    const Rigid3 by_object = truth * Rigid3{ExpSo3({0, 0, 0.017}), {0.2, 0, 0}};
    std::vector<PoseObservation> observations = Observe(truth, 120, 0.002, 0.0, &random);
    const Eigen::Vector3d direction = random.Bearing();
    for (int i = 0; i < 150; ++i) {
      const Eigen::Vector3d local =
          random.Uniform(4.0, 6.0) * (random.Rotation(0.12) * direction).normalized();
      observations.push_back({by_object * local, random.Noisy(local.normalized(), 0.002), 0.002});
    }
    const RefinedPose found = RefinePose(by_object, observations);
    EXPECT_LT(found.world_from_camera.rotation.angularDistance(truth.rotation), 3e-3);
    EXPECT_LT((found.world_from_camera.translation - truth.translation).norm(), 0.03);
    EXPECT_GT(found.inlier_ratio, 0.6);
  }
}

TEST(PoseRefinement, PriorDecidesWhereAllLandmarksAreFar) {
  RandomGeometry random(5);
  const Rigid3 truth = random.Transform();
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d local = random.Point(500.0, 1000.0);
    observations.push_back({truth * local, random.Noisy(local.normalized(), 0.002), 0.002});
  }
  const PositionPrior prior{.position = truth.translation,
                            .sqrt_information = 50 * Eigen::Matrix3d::Identity()};  // 2 cm
  const Rigid3 guess = Disturb(truth, &random);
  const RefinedPose with = RefinePose(guess, observations, prior);
  const RefinedPose without = RefinePose(guess, observations);
  EXPECT_LT((with.world_from_camera.translation - truth.translation).norm(), 0.01);
  EXPECT_GT((without.world_from_camera.translation - truth.translation).norm(), 0.05);
  EXPECT_LT(with.world_from_camera.rotation.angularDistance(truth.rotation), 1e-3);
}

TEST(PoseRefinement, NearLandmarksOverruleAWrongPrior) {
  RandomGeometry random(6);
  const Rigid3 truth = random.Transform();
  const PositionPrior prior{.position = truth.translation + Eigen::Vector3d(0.5, 0, 0),
                            .sqrt_information = 50 * Eigen::Matrix3d::Identity()};
  const RefinedPose found =
      RefinePose(Disturb(truth, &random), Observe(truth, 400, 0.002, 0.0, &random), prior);
  EXPECT_LT((found.world_from_camera.translation - truth.translation).norm(), 0.02);
}

TEST(PoseRefinement, KeepsTheGuessWhereNothingFits) {
  const Rigid3 guess{ExpSo3({0.1, 0.2, 0.3}), {1, 2, 3}};
  const RefinedPose found = RefinePose(guess, {});
  EXPECT_EQ(found.num_inliers, 0);
  EXPECT_EQ(found.world_from_camera.translation, guess.translation);
}

}  // namespace
}  // namespace orb360
