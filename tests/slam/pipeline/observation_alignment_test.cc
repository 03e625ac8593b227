#include "slam/pipeline/observation_alignment.h"

#include <gtest/gtest.h>

#include "nn/base/statistics.h"
#include "tests/slam/pipeline/patch_scene.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

const Rigid3 kStep{ExpSo3({0.05, -0.04, 0.3}), {-0.5, 0.2, 0.1}};

TEST(AlignObservations, BringsCornersToAFifthOfTheirErrorFromAnyDirection) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  AlignObservations(second, {}, &scene.map);
  double fraction = 0;
  EXPECT_NEAR(scene.Error(second, false), 0.5, 1e-3);
  EXPECT_LT(scene.Error(second, true, &fraction), 0.1);
  EXPECT_GT(fraction, 0.8);
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    const Observation& o = scene.map.landmark(l).observations[1];
    const float corner = scene.map.keyframe(second).features->keypoints[o.feature].sigma;
    EXPECT_LT(o.aligned_sigma, 0.5f * corner);
  }
}

TEST(AlignObservations, WarpsThePatchHoweverTheCameraIsHeldAndWhereverItIs) {
  for (const uint8_t level : {0, 5}) {
    PatchScene scene;
    scene.level = level;
    AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
    // Rolled by a quarter turn, and a metre and a half nearer to one wall.
    const KeyframeId second = scene.AddKeyframe({ExpSo3({1.57, 0.2, 0.4}), {-1.5, 0.4, 0.3}}, true);
    AlignObservations(second, {}, &scene.map);
    double fraction = 0;
    const double error = scene.Error(second, true, &fraction);
    EXPECT_LT(error, 0.125 * RangeAtLevelZero(1, level)) << int{level};
    EXPECT_GT(fraction, 0.4) << int{level};
  }
}

// As patch_slope is: of the plane through a landmark, per sample of its patch.
Eigen::Vector2d SlopeOf(const Map& map, const Landmark& landmark, const Eigen::Vector3d& normal) {
  const LandmarkPatch& patch = *landmark.patch;
  const Eigen::Vector3d seen = map.PoseOf(patch.keyframe).rotation.conjugate() * normal;
  return patch.spacing * (TangentBasis(patch.bearing).transpose() * seen) / seen.dot(patch.bearing);
}

TEST(AlignObservations, LearnsHowSurfacesLieAndTakesThemForThat) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  for (const double x : {-0.5, -1.0, -1.5, -2.0}) {
    const Rigid3 pose{Eigen::Quaterniond::Identity(), {x, 0.3, 0.4 * x}};
    AlignObservations(scene.AddKeyframe(pose, true), {}, &scene.map);
  }
  std::vector<double> errors;
  std::vector<double> before;  // as if it faced the camera
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    const Landmark& landmark = scene.map.landmark(l);
    const bool is_aligned = landmark.observations.back().aligned_sigma > 0;
    const Eigen::Vector3d& p = scene.shown[l];
    if (!landmark.patch || !is_aligned) continue;
    const Eigen::Vector3d from_middle(p.x() / 6.0, p.y() / 5.0, p.z() / 3.0);
    Eigen::Index wall = 0;
    if (from_middle.cwiseAbs().maxCoeff(&wall) < 0.999) continue;
    const Eigen::Vector2d truth = SlopeOf(scene.map, landmark, Eigen::Vector3d::Unit(wall));
    errors.push_back((landmark.patch_slope.mean - truth).norm() / landmark.patch->spacing);
    before.push_back(truth.norm() / landmark.patch->spacing);
  }
  ASSERT_GT(errors.size(), 60u);
  EXPECT_LT(Median(errors), 0.5 * Median(before));
}

TEST(AlignObservations, ExpectsTheGroundToLieLikeTheGround) {
  PatchScene scene;
  const KnownGround ground{Eigen::Vector3d::UnitZ(), 3.0};
  AlignObservations(scene.AddKeyframe({}, true), ground, &scene.map);
  int on_ground = 0;
  int elsewhere = 0;
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    const Landmark& landmark = scene.map.landmark(l);
    if (!landmark.patch) continue;
    if (landmark.position.z() < -2.99) {
      ++on_ground;
      const Eigen::Vector2d truth = SlopeOf(scene.map, landmark, Eigen::Vector3d::UnitZ());
      EXPECT_LT((landmark.patch_slope.mean - truth).norm(), 1e-9) << l;
    } else if (landmark.position.z() > -2.5) {
      ++elsewhere;
      EXPECT_EQ(landmark.patch_slope.mean, Eigen::Vector2d::Zero()) << l;
    }
  }
  EXPECT_GT(on_ground, 5);
  EXPECT_GT(elsewhere, 20);
}

TEST(AlignObservations, AlignsWhatComesFromAnotherLandmark) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  const KeyframeId third = scene.AddKeyframe({}, true);
  // The second keyframe's feature is another landmark's, until both become one.
  scene.map.RemoveObservation(4, second);
  const LandmarkId other = scene.map.AddLandmark(scene.map.landmark(4).position, {});
  scene.map.AddObservation(other, second, 4);
  AlignObservations(second, {}, &scene.map);
  scene.map.MergeLandmark(other, 4);
  EXPECT_EQ(scene.map.landmark(4).FindObservation(second)->aligned_sigma, 0);
  AlignObservations(third, {}, &scene.map);
  EXPECT_GT(scene.map.landmark(4).FindObservation(second)->aligned_sigma, 0);
}

TEST(AlignObservations, WhatHasTurnedOutWrongStaysACorner) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  AlignObservations(second, {}, &scene.map);
  Landmark& landmark = scene.map.landmark(4);
  ASSERT_GT(landmark.observations[1].aligned_sigma, 0);
  for (Observation& o : landmark.observations) o.aligned_sigma = 0;  // as bundle adjustment does
  landmark.observations[0].aligned_sigma = 0.001f;
  const PatchSlope before = landmark.patch_slope;
  AlignObservations(second, {}, &scene.map);
  EXPECT_EQ(landmark.observations[1].aligned_sigma, 0);
  EXPECT_EQ(landmark.patch_slope.information, before.information);
}

TEST(AlignObservations, TakesNoPatchBesideAPole) {
  PatchScene scene;
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    const double off =
        kPatchCamera.AngleOfPixels(1.0 + 0.05 * l) * 3.0;  // of the ceiling's middle, m
    scene.shown[l] = {off, 0.5 * off, 3.0};
  }
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    EXPECT_EQ(scene.map.landmark(l).patch, nullptr) << l;
  }
}

TEST(AlignObservations, LeavesWhatIsSeenFromMuchFartherAway) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({Eigen::Quaterniond::Identity(), {4.8, 0, 0}}, true), {},
                    &scene.map);
  const KeyframeId second = scene.AddKeyframe({Eigen::Quaterniond::Identity(), {-4.0, 0, 0}}, true);
  AlignObservations(second, {}, &scene.map);
  int checked = 0;
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    if (scene.shown[l].x() < 5.99 || (scene.shown[l] - Eigen::Vector3d(4.8, 0, 0)).norm() > 4) {
      continue;
    }
    ++checked;
    EXPECT_EQ(scene.map.landmark(l).observations[1].aligned_sigma, 0) << l;
  }
  EXPECT_GT(checked, 5);
}

TEST(AlignObservations, AWrongPatchGoesWithItsObservation) {
  PatchScene scene;
  const KeyframeId first = scene.AddKeyframe({}, true);
  AlignObservations(first, {}, &scene.map);
  scene.map.RemoveObservation(3, first);
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  AlignObservations(second, {}, &scene.map);
  EXPECT_EQ(scene.map.landmark(3).patch->keyframe, second);
  EXPECT_EQ(scene.map.landmark(4).patch->keyframe, first);
}

TEST(AlignObservations, WhatIsAlignedWithAPatchThatWasNotKeptGetsNoOther) {
  PatchScene scene;
  const KeyframeId first = scene.AddKeyframe({}, true);
  AlignObservations(first, {}, &scene.map);
  scene.map.landmark(3).patch.reset();  // as in a map that was read from a file
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  AlignObservations(second, {}, &scene.map);
  EXPECT_EQ(scene.map.landmark(3).patch, nullptr);
  EXPECT_EQ(scene.map.landmark(3).observations[1].aligned_sigma, 0);
}

TEST(AlignObservations, AlignsWhatOlderKeyframesShowWithThePatchOfANewLandmark) {
  PatchScene scene;
  const KeyframeId older = scene.AddKeyframe(kStep, true);
  const KeyframeId gone = scene.AddKeyframe({ExpSo3({0, 0, 0.1}), {0.2, 0, 0}}, false);
  const KeyframeId newest = scene.AddKeyframe({}, true);
  AlignObservations(newest, {}, &scene.map);
  double fraction = 0;
  // The newest keyframe's corners are half a pixel off: that is where its patches are.
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    const Landmark& landmark = scene.map.landmark(l);
    ASSERT_NE(landmark.patch, nullptr);
    EXPECT_EQ(landmark.patch->keyframe, newest);
    const Eigen::Vector3d ray = scene.map.keyframe(newest).features->bearings[l];
    scene.shown[l] = scene.room.Range({0, 0, 0}, ray) * ray;
  }
  EXPECT_LT(scene.Error(older, true, &fraction), 0.1);
  EXPECT_GT(fraction, 0.8);
  scene.Error(gone, true, &fraction);
  EXPECT_EQ(fraction, 0);  // its image was not kept
}

TEST(AlignObservations, LeavesWhatLooksDifferent) {
  PatchScene scene;
  AlignObservations(scene.AddKeyframe({}, true), {}, &scene.map);
  const KeyframeId second = scene.AddKeyframe(kStep, true);
  // Another room's image.
  scene.map.keyframe(second).image = ImageOf(BoxRoom({6.0, 5.0, 3.0}, 99), kStep);
  AlignObservations(second, {}, &scene.map);
  double fraction = 0;
  scene.Error(second, true, &fraction);
  EXPECT_LT(fraction, 0.05);
}

TEST(AlignObservations, ANeverKeptImageChangesNothing) {
  PatchScene scene;
  const KeyframeId id = scene.AddKeyframe({}, false);
  AlignObservations(id, {}, &scene.map);
  for (LandmarkId l = 0; l < scene.map.landmark_end(); ++l) {
    EXPECT_EQ(scene.map.landmark(l).patch, nullptr);
  }
}

}  // namespace
}  // namespace orb360
