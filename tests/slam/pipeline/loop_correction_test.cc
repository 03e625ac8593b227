#include "slam/pipeline/loop_correction.h"

#include <numbers>

#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"
#include "slam/geometry/alignment.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "tests/slam/pipeline/ring_street.h"

namespace orb360 {
namespace {

constexpr int kLap = 90;

double ArcOf(int keyframe) { return 2.0 * std::numbers::pi * keyframe / kLap; }

struct Closed {
  RingStreet::Drive drive;
  Map before;
  std::vector<Similarity3> corrections;
};

// An even image for the newest keyframe.
void KeepImage(Map* map) {
  SpherePyramid image;
  BuildSpherePyramid(cv::Mat(512, 1024, CV_8U, cv::Scalar(90)), 8, &image);
  map->keyframe(map->keyframe_end() - 1).image =
      std::make_shared<const SpherePyramid>(std::move(image));
}

// A lap that drifts, until the loop is closed.
Closed DriveAndClose() {
  RingStreet street(2000);
  Closed closed;
  LoopDetector detector({}, {}, 12, RingStreet::kSigma);
  const Similarity3 drift{std::exp(0.06 / kLap), ExpSo3({0, 0, 0.09 / kLap}), {0, 0, 1.9 / kLap}};
  for (int k = 0; k < kLap + 15; ++k) {
    const KeyframeId id = street.DriveOn(RingStreet::PoseAt(ArcOf(k)), drift, &closed.drive);
    if (const auto loop = detector.Observe(closed.drive.map, id, {})) {
      KeepImage(&closed.drive.map);
      closed.before = closed.drive.map;
      closed.corrections = CloseLoop(*loop, &closed.drive.map);
      break;
    }
  }
  return closed;
}

// Root mean square of the keyframes' positions after the best similarity, m.
double PathError(const Map& map, const std::vector<Rigid3>& truth) {
  std::vector<Eigen::Vector3d> found, expected;
  for (const KeyframeId id : map.KeyframeIds()) {
    found.push_back(map.keyframe(id).world_from_camera.translation);
    expected.push_back(truth[id].translation);
  }
  const Similarity3 fit = AlignSimilarity(found, expected).value();
  double sum = 0;
  for (size_t i = 0; i < found.size(); ++i) sum += (fit * found[i] - expected[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(found.size()));
}

TEST(CloseLoop, TakesAwayMostOfTheDriftAndJoinsTheEnds) {
  const Closed closed = DriveAndClose();
  ASSERT_FALSE(closed.corrections.empty());
  const Map& map = closed.drive.map;
  map.CheckConsistency();
  const double before = PathError(closed.before, closed.drive.truth);
  const double after = PathError(map, closed.drive.truth);
  EXPECT_GT(before, 0.5);
  EXPECT_LT(after, 0.35 * before);
  // The newest keyframe sees what the first ones saw.
  const KeyframeId newest = map.keyframe_end() - 1;
  bool meets_first = false;
  for (const Map::Covisible& near : map.FindCovisible(map.keyframe(newest).landmarks, 30, newest)) {
    meets_first |= near.keyframe < 12;
  }
  EXPECT_TRUE(meets_first);
  EXPECT_LT(map.num_landmarks(), closed.before.num_landmarks() - 100);
  // Corrections are what moved the cameras.
  for (const KeyframeId id : map.KeyframeIds()) {
    const Rigid3 moved =
        TransformPose(closed.corrections[id], closed.before.keyframe(id).world_from_camera);
    EXPECT_LT((moved.translation - map.keyframe(id).world_from_camera.translation).norm(), 1e-9);
  }
}

TEST(CloseLoop, AlignsWhatTheEndsShow) {
  const Closed closed = DriveAndClose();
  const Map& map = closed.drive.map;
  int patches = 0;  // that are cut before anything is aligned with them
  for (const LandmarkId id : map.keyframe(map.keyframe_end() - 1).landmarks) {
    patches += id != kNoId && map.landmark(id).patch != nullptr;
  }
  EXPECT_GT(patches, 30);
}

TEST(CloseLoop, BundleAdjustmentFinishesWhatThePoseGraphBegan) {
  Closed closed = DriveAndClose();
  const double before = PathError(closed.drive.map, closed.drive.truth);
  Map adjusted = closed.drive.map;
  AdjustGlobally(20, std::nullopt, 0.0, &adjusted);
  EXPECT_LT(PathError(adjusted, closed.drive.truth), 0.5 * before);
}

TEST(AdoptAdjustment, GivesTheAdjustedMapWhereNothingElseHappened) {
  Closed closed = DriveAndClose();
  const Map before = closed.drive.map;
  Map adjusted = before;
  AdjustGlobally(5, std::nullopt, 0.0, &adjusted);
  Map map = before;
  AdoptAdjustment(before, adjusted, &map);
  map.CheckConsistency();
  for (const KeyframeId id : map.KeyframeIds()) {
    EXPECT_LT((map.keyframe(id).world_from_camera.translation -
               adjusted.keyframe(id).world_from_camera.translation)
                  .norm(),
              1e-9);
  }
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    if (!map.HasLandmark(id) || !adjusted.HasLandmark(id)) continue;
    EXPECT_LT((map.landmark(id).position - adjusted.landmark(id).position).norm(), 1e-9);
  }
}

// While a copy was adjusted (here: moved as a whole, and enlarged) the drive went on.
TEST(AdoptAdjustment, WhatIsNewerMovesAlong) {
  RingStreet street(2000);
  RingStreet::Drive drive;
  for (int k = 0; k < 30; ++k) street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive);
  const Map before = drive.map;
  Map adjusted = before;
  const Similarity3 moved{1.2, ExpSo3({0, 0, 0.3}), {5, 0, 1}};
  adjusted.Transform(moved);
  for (int k = 30; k < 36; ++k) street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &drive);
  drive.map.RemoveKeyframe(20, 21);
  Map map = drive.map;
  const std::vector<Similarity3> corrections = AdoptAdjustment(before, adjusted, &map);
  map.CheckConsistency();
  ASSERT_EQ(corrections.size(), 36u);
  for (KeyframeId id = 0; id < 36; ++id) {
    EXPECT_NEAR(corrections[id].scale, 1.2, 1e-9);
    EXPECT_LT((map.PoseOf(id).translation - moved * drive.map.PoseOf(id).translation).norm(), 1e-9);
  }
  for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
    if (!map.HasLandmark(id)) continue;
    EXPECT_LT((map.landmark(id).position - moved * drive.map.landmark(id).position).norm(), 1e-9);
  }
}

TEST(MergeMaps, PutsTheNewMapIntoTheOldOnesWorld) {
  RingStreet street(2000);
  LoopDetector detector({}, {}, 12, RingStreet::kSigma);
  RingStreet::Drive first;
  for (int k = 0; k < 30; ++k) {
    detector.Observe(first.map, street.DriveOn(RingStreet::PoseAt(ArcOf(k)), {}, &first), {});
  }
  const std::vector<Map> finished = {first.map};
  RingStreet::Drive second;
  second.drift = {0.5, ExpSo3({0.1, 0.2, 1.0}), {7, 8, 9}};
  std::optional<Loop> loop;
  for (int k = 40; k > 10 && !loop; --k) {
    const Rigid3 pose = RingStreet::PoseAt(ArcOf(k), 0.5, 2.0);
    loop = detector.Observe(second.map, street.DriveOn(pose, {}, &second), finished);
  }
  ASSERT_TRUE(loop.has_value());
  Similarity3 correction;
  const Map joined = MergeMaps(*loop, second.map, first.map, &correction);
  joined.CheckConsistency();
  const KeyframeId shift = first.map.keyframe_end();
  EXPECT_EQ(joined.num_keyframes(), first.map.num_keyframes() + second.map.num_keyframes());
  EXPECT_LT(joined.num_landmarks(), first.map.num_landmarks() + second.map.num_landmarks() - 100);
  std::vector<Rigid3> truth = first.truth;
  truth.insert(truth.end(), second.truth.begin(), second.truth.end());
  EXPECT_LT(PathError(joined, truth), 0.2);
  for (size_t k = 0; k < second.truth.size(); ++k) {
    const Eigen::Vector3d moved =
        correction * second.map.keyframe(static_cast<KeyframeId>(k)).world_from_camera.translation;
    EXPECT_LT((joined.PoseOf(shift + static_cast<KeyframeId>(k)).translation - moved).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace orb360
