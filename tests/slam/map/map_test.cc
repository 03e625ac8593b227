#include <memory>

#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"
#include "tests/slam/pipeline/synthetic_scene.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/map/map.h>

namespace orb360 {
namespace {

Map SmallMap() {
  SyntheticScene scene(40);
  return scene.MakeMap(Walk(4, {-0.5, 0.1, 0.0}), 30);
}

TEST(Map, KeepsKeyframesAndLandmarksInAgreement) {
  Map map = SmallMap();
  map.CheckConsistency();
  map.RemoveObservation(3, 2);
  EXPECT_EQ(map.keyframe(2).landmarks[3], kNoId);
  EXPECT_EQ(map.landmark(3).observations.size(), 3u);
  map.RemoveLandmark(5);
  EXPECT_EQ(map.keyframe(0).landmarks[5], kNoId);
  map.RemoveKeyframe(1, 0);
  EXPECT_EQ(map.landmark(7).observations.size(), 3u);
  map.CheckConsistency();
  EXPECT_EQ(map.num_keyframes(), 3);
  EXPECT_EQ(map.num_landmarks(), 29);
}

TEST(Map, ACornerIsMappedByTheFeatureOfWhicheverLevel) {
  Map map = SmallMap();
  auto features = std::make_shared<Features>(*map.keyframe(1).features);
  features->corners[35] = 7;   // 7 is a landmark
  features->corners[12] = 38;  // 38 is none itself
  map.keyframe(1).features = features;
  const std::vector<uint8_t> is_mapped = FindMappedCorners(map.keyframe(1));
  ASSERT_EQ(std::ssize(is_mapped), features->size());
  const auto is_known = [&](int feature) { return is_mapped[features->corners[feature]] != 0; };
  for (const int feature : {0, 7, 12, 29, 35, 38}) EXPECT_TRUE(is_known(feature)) << feature;
  for (const int feature : {30, 34, 36, 39}) EXPECT_FALSE(is_known(feature)) << feature;
}

TEST(Map, NoticesABrokenAgreement) {
  Map map = SmallMap();
  map.keyframe(1).landmarks[4] = kNoId;
  EXPECT_THROW(map.CheckConsistency(), ContractError);
}

TEST(Map, MergingMovesObservationsOnceAndLeavesATrace) {
  Map map = SmallMap();
  const LandmarkId twin = map.AddLandmark({1, 2, 3}, {});
  map.AddObservation(twin, 0, 35);  // keyframe 0 sees landmark 2 already
  map.RemoveObservation(2, 3);
  map.AddObservation(twin, 3, 36);
  map.landmark(twin).visible = 7;
  map.MergeLandmark(twin, 2);
  map.CheckConsistency();
  EXPECT_FALSE(map.HasLandmark(twin));
  EXPECT_EQ(map.Resolve(twin), 2);
  EXPECT_EQ(map.landmark(2).observations.size(), 4u);
  EXPECT_EQ(map.keyframe(3).landmarks[36], 2);
  EXPECT_EQ(map.keyframe(0).landmarks[35], kNoId);
  EXPECT_EQ(map.landmark(2).visible, 8);
  map.MergeLandmark(2, 9);
  EXPECT_EQ(map.Resolve(twin), 9);
  map.RemoveLandmark(9);
  EXPECT_EQ(map.Resolve(twin), kNoId);
}

TEST(Map, ARemovedKeyframesPoseFollowsItsSuccessor) {
  Map map = SmallMap();
  const Rigid3 removed = map.keyframe(2).world_from_camera;
  map.RemoveKeyframe(2, 1);
  EXPECT_LT((map.PoseOf(2).translation - removed.translation).norm(), 1e-12);
  EXPECT_EQ(map.LivingKeyframe(2), 1);
  const Rigid3 shift{ExpSo3({0, 0, 0.5}), {1, 2, 3}};
  map.keyframe(1).world_from_camera = shift * map.keyframe(1).world_from_camera;
  EXPECT_LT((map.PoseOf(2).translation - shift * removed.translation).norm(), 1e-12);
  map.RemoveKeyframe(1, 0);  // a chain
  EXPECT_EQ(map.LivingKeyframe(2), 0);
  EXPECT_LT((map.PoseOf(2).translation - shift * removed.translation).norm(), 1e-12);
}

TEST(Map, CovisibleKeyframesAreCountedAndOrdered) {
  Map map = SmallMap();
  for (int i = 0; i < 20; ++i) map.RemoveObservation(i, 1);
  for (int i = 0; i < 5; ++i) map.RemoveObservation(i, 3);
  const std::vector<Map::Covisible> found = map.FindCovisible(map.keyframe(0).landmarks, 1, 0);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].keyframe, 2);
  EXPECT_EQ(found[0].shared, 30);
  EXPECT_EQ(found[1].keyframe, 3);
  EXPECT_EQ(found[1].shared, 25);
  EXPECT_EQ(found[2].keyframe, 1);
  EXPECT_EQ(found[2].shared, 10);
  EXPECT_EQ(map.FindCovisible(map.keyframe(0).landmarks, 26, 0).size(), 1u);
}

TEST(Map, AChangeOfGaugeChangesNoImage) {
  Map map = SmallMap();
  const Map before = map;
  map.RemoveKeyframe(3, 2);
  map.keyframe(1).range_priors = {{2.0F, 0.1F}};
  const Similarity3 gauge{2.5, ExpSo3({0.3, -0.2, 1.0}), {4, 5, 6}};
  map.Transform(gauge);
  EXPECT_FLOAT_EQ(map.keyframe(1).PriorOf(0).range, 5.0F);
  EXPECT_FLOAT_EQ(map.keyframe(1).PriorOf(0).sigma, 0.1F);
  EXPECT_EQ(map.keyframe(0).PriorOf(0).sigma, 0);  // not completed
  for (KeyframeId k = 0; k < 4; ++k) {
    EXPECT_LT((map.PoseOf(k).translation - gauge * before.PoseOf(k).translation).norm(), 1e-12);
    for (LandmarkId l = 0; l < 30; ++l) {
      const Eigen::Vector3d was = before.PoseOf(k).Inverse() * before.landmark(l).position;
      const Eigen::Vector3d is = map.PoseOf(k).Inverse() * map.landmark(l).position;
      EXPECT_LT((is - 2.5 * was).norm(), 1e-9);
    }
  }
  EXPECT_NEAR(map.MedianRange(0), 2.5 * before.MedianRange(0), 1e-9);
}

TEST(Map, BendingMovesLandmarksWithTheKeyframeInTheMiddle) {
  Map map = SmallMap();
  map.RemoveKeyframe(3, 2);
  for (const KeyframeId id : {0, 1}) map.keyframe(id).range_priors = {{2.0F, 0.1F}};
  const Map before = map;
  const Similarity3 moved{1.5, ExpSo3({0, 0, 0.2}), {1, 0, 0}};
  // Every landmark is seen from 0, 1 and 2.
  const std::vector<Similarity3> corrections = {{}, moved, moved, moved};
  map.Deform(corrections);
  map.CheckConsistency();
  EXPECT_EQ((map.PoseOf(0).translation - before.PoseOf(0).translation).norm(), 0.0);
  EXPECT_FLOAT_EQ(map.keyframe(0).PriorOf(0).range, 2.0F);
  EXPECT_FLOAT_EQ(map.keyframe(1).PriorOf(0).range, 3.0F);
  for (LandmarkId id = 0; id < 30; ++id) {
    const Eigen::Vector3d was = before.PoseOf(1).Inverse() * before.landmark(id).position;
    const Eigen::Vector3d is = map.PoseOf(1).Inverse() * map.landmark(id).position;
    EXPECT_LT((is - 1.5 * was).norm(), 1e-9);
    EXPECT_NEAR(map.landmark(id).max_range, 1.5 * before.landmark(id).max_range, 1e-12);
  }
  // The removed one follows, its distance from its successor scaled.
  EXPECT_LT((map.PoseOf(3).translation - moved * before.PoseOf(3).translation).norm(), 1e-12);
}

TEST(Map, AppendingKeepsBothMapsAndTheirHistory) {
  Map map = SmallMap();
  map.RemoveLandmark(7);
  Map other = SmallMap();
  other.RemoveKeyframe(2, 1);
  other.MergeLandmark(3, 4);
  const Map before = map;
  map.Append(other);
  map.CheckConsistency();
  EXPECT_EQ(map.num_keyframes(), 4 + 3);
  EXPECT_EQ(map.num_landmarks(), 29 + 29);
  EXPECT_FALSE(map.HasKeyframe(4 + 2));
  EXPECT_EQ(map.LivingKeyframe(4 + 2), 4 + 1);
  EXPECT_EQ(map.Resolve(30 + 3), 30 + 4);
  EXPECT_EQ((map.PoseOf(4 + 2).translation - other.PoseOf(2).translation).norm(), 0.0);
  EXPECT_EQ(map.landmark(30 + 9).first_keyframe, 4 + other.landmark(9).first_keyframe);
  EXPECT_EQ(map.keyframe(1).landmarks, before.keyframe(1).landmarks);
  EXPECT_EQ(map.keyframe(4 + 1).landmarks[9], 30 + 9);
}

TEST(Map, AnAppendedPatchStaysWithItsKeyframe) {
  Map map = SmallMap();
  Map other = SmallMap();
  other.landmark(8).patch =
      std::make_shared<const LandmarkPatch>(LandmarkPatch{3, {0.0, 0.6, 0.8}, 0.01, Patch{}});
  map.Append(other);
  EXPECT_EQ(map.landmark(30 + 8).patch->keyframe, 4 + 3);
  EXPECT_EQ(map.landmark(30 + 8).patch->spacing, 0.01);
  EXPECT_EQ(other.landmark(8).patch->keyframe, 3);
}

TEST(Map, AppendedStepsOverTheGroundStayWithTheirKeyframes) {
  Map map = SmallMap();
  Map other = SmallMap();
  other.keyframe(3).ground_steps.push_back({.keyframe = 2, .ratio = 0.7, .sigma = 0.01});
  map.Append(other);
  EXPECT_EQ(map.keyframe(4 + 3).ground_steps.front().keyframe, 4 + 2);
  EXPECT_EQ(map.keyframe(4 + 3).ground_steps.front().ratio, 0.7);
}

TEST(Map, ForgetsTheImagesOfAllButTheNewestKeyframes) {
  Map map = SmallMap();
  for (const KeyframeId id : map.KeyframeIds()) {
    map.keyframe(id).image = std::make_shared<const SpherePyramid>();
  }
  map.RemoveKeyframe(2, 1);
  map.ForgetImages(2);
  EXPECT_EQ(map.keyframe(0).image, nullptr);
  EXPECT_NE(map.keyframe(1).image, nullptr);
  EXPECT_NE(map.keyframe(3).image, nullptr);
  map.ForgetImages(0);
  EXPECT_EQ(map.keyframe(3).image, nullptr);
}

TEST(Map, WhatWasAlignedWithAPatchIsNotWithThatOfTheLandmarkItJoins) {
  Map map = SmallMap();
  const LandmarkId twin = map.AddLandmark({1, 2, 3}, {});
  map.RemoveObservation(2, 3);
  map.AddObservation(twin, 3, 36);
  map.landmark(twin).observations[0].aligned_sigma = 0.001f;
  map.MergeLandmark(twin, 2);
  EXPECT_EQ(map.landmark(2).observations[3].feature, 36);
  EXPECT_EQ(map.landmark(2).observations[3].aligned_sigma, 0);
}

TEST(Map, LevelsAndRangesAreInverse) {
  for (int level = 0; level < 8; ++level) {
    EXPECT_EQ(PredictLevel(RangeAtLevelZero(3.7, level), 3.7), level);
  }
}

TEST(Map, ContractsAreChecked) {
  Map map = SmallMap();
  EXPECT_THROW(map.AddObservation(4, 0, 35), ContractError);   // sees it already
  EXPECT_THROW(map.AddObservation(31, 0, 35), ContractError);  // no such landmark
  EXPECT_THROW(map.RemoveKeyframe(1, 1), ContractError);
  EXPECT_THROW(map.keyframe(9), ContractError);
}

}  // namespace
}  // namespace orb360
