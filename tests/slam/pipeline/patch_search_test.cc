#include "slam/pipeline/patch_search.h"

#include <gtest/gtest.h>

#include "slam/pipeline/observation_alignment.h"
#include "tests/slam/pipeline/patch_scene.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const Rigid3 kStep{ExpSo3({0.05, -0.04, 0.3}), {-0.5, 0.2, 0.1}};
constexpr size_t kCorners = 40;  // that the second keyframe finds itself

class FindByPatchesTest : public testing::Test {
 protected:
  FindByPatchesTest() {
    AlignObservations(scene_.AddKeyframe({}, true), {}, &scene_.map);
    second_ = scene_.AddKeyframe(kStep, true, kCorners);
    AlignObservations(second_, {}, &scene_.map);
  }

  // Landmarks that the second keyframe sees.
  int NumSeen() const {
    const std::vector<LandmarkId>& landmarks = scene_.map.keyframe(second_).landmarks;
    return static_cast<int>(
        std::ranges::count_if(landmarks, [](LandmarkId l) { return l != kNoId; }));
  }

  PatchScene scene_;
  KeyframeId second_;
};

TEST_F(FindByPatchesTest, FindsWhatIsNoCornerToATenthOfAPixel) {
  const std::shared_ptr<const Features> before = scene_.map.keyframe(second_).features;
  FindByPatches(second_, 15, &scene_.map);
  double fraction = 0;
  EXPECT_LT(scene_.Error(second_, true, &fraction), 0.1);
  EXPECT_GT(fraction, 0.8);
  scene_.map.CheckConsistency();
  const Features& features = *scene_.map.keyframe(second_).features;
  ASSERT_GT(features.size(), static_cast<int>(kCorners));
  for (int f = 0; f < features.size(); ++f) {
    EXPECT_EQ(features.keypoints[f].is_corner(), f < static_cast<int>(kCorners)) << f;
    if (features.keypoints[f].is_corner()) continue;
    EXPECT_LE(features.keypoints[f].level, 1) << f;  // as near as in the first keyframe
    EXPECT_EQ(features.corners[f], f);
    const Observation& o =
        *scene_.map.landmark(scene_.map.keyframe(second_).landmarks[f]).FindObservation(second_);
    EXPECT_LT(o.aligned_sigma, 0.5F * features.keypoints[f].sigma);
    EXPECT_TRUE(o.was_compared);
  }
  EXPECT_EQ(before->size(), static_cast<int>(kCorners)) << "others have these features too";
}

TEST_F(FindByPatchesTest, CornersWithoutALandmarkBecomeItsObservations) {
  scene_.map.RemoveObservation(7, second_);
  FindByPatches(second_, 15, &scene_.map);
  const Observation* found = scene_.map.landmark(7).FindObservation(second_);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->feature, 7);
  EXPECT_GT(found->aligned_sigma, 0);
}

TEST_F(FindByPatchesTest, WhereAnotherLandmarkIsSeenNothingChanges) {
  scene_.map.RemoveObservation(7, second_);
  const LandmarkId other = scene_.map.AddLandmark(scene_.shown[7], {});
  scene_.map.AddObservation(other, second_, 7);
  FindByPatches(second_, 15, &scene_.map);
  EXPECT_EQ(scene_.map.landmark(7).FindObservation(second_), nullptr);
  EXPECT_EQ(scene_.map.keyframe(second_).landmarks[7], other);
}

TEST_F(FindByPatchesTest, OfTwoLandmarksAtOnePlaceItSeesTheOlder) {
  const LandmarkId last = static_cast<LandmarkId>(scene_.shown.size()) - 1;
  const Landmark original = scene_.map.landmark(last);
  const LandmarkId twin = scene_.map.AddLandmark(original.position, {});
  const KeyframeId third = scene_.AddKeyframe({ExpSo3({0, 0, 0.1}), {0.2, 0, 0}}, false, kCorners);
  Landmark& copy = scene_.map.landmark(twin);
  copy.patch = original.patch;
  copy.patch_slope = original.patch_slope;
  scene_.map.RemoveObservation(0, third);
  scene_.map.AddObservation(twin, third, 0);
  scene_.map.UpdateAppearance(twin);
  FindByPatches(second_, 15, &scene_.map);
  EXPECT_NE(scene_.map.landmark(last).FindObservation(second_), nullptr);
  EXPECT_EQ(scene_.map.landmark(twin).FindObservation(second_), nullptr);
}

TEST_F(FindByPatchesTest, WhatIsSeenFromTheOtherSideOnlyIsNotSought) {
  for (LandmarkId l = kCorners; l < scene_.map.landmark_end(); ++l) {
    scene_.map.landmark(l).mean_direction *= -1;
  }
  FindByPatches(second_, 15, &scene_.map);
  EXPECT_EQ(NumSeen(), static_cast<int>(kCorners));
}

TEST_F(FindByPatchesTest, WhatLooksDifferentIsNotFound) {
  scene_.map.keyframe(second_).image = ImageOf(BoxRoom({6.0, 5.0, 3.0}, 99), kStep);
  FindByPatches(second_, 15, &scene_.map);
  EXPECT_LT(NumSeen() - static_cast<int>(kCorners),
            0.1 * static_cast<double>(scene_.shown.size() - kCorners));
}

TEST_F(FindByPatchesTest, WithoutAnImageOrNeighboursNothingChanges) {
  FindByPatches(second_, 0, &scene_.map);
  EXPECT_EQ(NumSeen(), static_cast<int>(kCorners));
  scene_.map.ForgetImages(0);
  FindByPatches(second_, 15, &scene_.map);
  EXPECT_EQ(NumSeen(), static_cast<int>(kCorners));
}

}  // namespace
}  // namespace orb360
