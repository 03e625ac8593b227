#include "slam/pipeline/frame_refinement.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

const Rigid3 kTruth{ExpSo3({0.1, -0.2, 0.3}), {0.6, 0.1, 0.0}};
const Rigid3 kNear{ExpSo3({0.11, -0.2, 0.3}), {0.63, 0.08, 0.02}};

/// A map with all points at their true places, and how a frame between two of its keyframes sees
/// them.
struct Sight {
  SyntheticScene scene{200};
  Map map = scene.MakeMap({Rigid3(), {Eigen::Quaterniond::Identity(), {1, 0, 0}}}, 200);
  std::vector<Sighting> sightings;

  explicit Sight(double noise) {
    TrackedFrame frame;
    frame.features = scene.See(kTruth, noise);
    frame.landmarks = map.keyframe(0).landmarks;
    sightings = SightingsOf(frame);
  }
};

void ExpectNear(const Rigid3& pose, const Rigid3& truth, double tolerance) {
  EXPECT_LT((pose.translation - truth.translation).norm(), tolerance);
  EXPECT_LT(pose.rotation.angularDistance(truth.rotation), tolerance);
}

TEST(FrameRefinement, FindsThePoseInWhichTheLandmarksAreSeen) {
  const Sight exact(0.0);
  ASSERT_EQ(exact.sightings.size(), 200u);
  ExpectNear(RefineFrame(exact.map, kNear, exact.sightings), kTruth, 1e-5);  // floats
  const Sight noisy(1.0);
  ExpectNear(RefineFrame(noisy.map, kNear, noisy.sightings), kTruth, 3e-3);
}

TEST(FrameRefinement, FollowsLandmarksThatBecameOthersAndMissesRemovedOnes) {
  Sight sight(0.0);
  const LandmarkId first = sight.sightings[0].landmark;
  const LandmarkId last = sight.sightings.back().landmark;
  // The last one's place is the first one's now: what was seen as the last is wrong, and left out.
  sight.map.MergeLandmark(last, first);
  for (int i = 1; i < 60; ++i) sight.map.RemoveLandmark(sight.sightings[i].landmark);
  ExpectNear(RefineFrame(sight.map, kNear, sight.sightings), kTruth, 1e-5);
}

TEST(FrameRefinement, LeavesAPoseWhoseLandmarksAreGone) {
  Sight sight(0.0);
  for (int i = 0; i < 120; ++i) sight.map.RemoveLandmark(sight.sightings[i].landmark);
  ExpectNear(RefineFrame(sight.map, kNear, sight.sightings), kNear, 1e-12);
  ExpectNear(RefineFrame(sight.map, kNear, std::span(sight.sightings).last(10)), kNear, 1e-12);
  ExpectNear(RefineFrame(sight.map, kNear, {}), kNear, 1e-12);
}

TEST(FrameRefinement, AMinorityIsEnoughWhereItAgreesWithThePrior) {
  Sight sight(1.0);
  for (LandmarkId id = 0; id < 120; ++id) {  // seen in a wrong pose
    sight.map.landmark(id).position = sight.scene.random.Point(2.0, 20.0);
  }
  const PositionPrior prior{.position = kTruth.translation + Eigen::Vector3d(0.02, 0.01, 0),
                            .sqrt_information = Eigen::Matrix3d::Identity() / 0.03};
  const Rigid3 wrong{kTruth.rotation, kTruth.translation + Eigen::Vector3d(0.3, 0, 0)};
  ExpectNear(RefineFrame(sight.map, wrong, sight.sightings), wrong, 1e-12);
  ExpectNear(RefineFrame(sight.map, wrong, sight.sightings, prior), kTruth, 0.01);
}

TEST(FrameRefinement, ItsPriorWinsAgainstLandmarksThatSayThatTheCameraHasLeftThePath) {
  const Sight sight(1.0);
  PositionPrior prior{.position = kTruth.translation + Eigen::Vector3d(0.5, 0, 0),
                      .sqrt_information = Eigen::Matrix3d::Identity() / 0.05};
  // Two hundred near landmarks are stronger than the prior, but say that it is wrong by ten sigmas.
  const Rigid3 refined = RefineFrame(sight.map, kNear, sight.sightings, prior);
  EXPECT_EQ(refined.translation, prior.position);
  EXPECT_LT(refined.rotation.angularDistance(kTruth.rotation), 0.01);
  // Three sigmas happen.
  prior.sqrt_information = Eigen::Matrix3d::Identity() / 0.17;
  ExpectNear(RefineFrame(sight.map, kNear, sight.sightings, prior), kTruth, 0.01);
}

TEST(FrameRefinement, TakesThePositionFromItsPriorWhereAllLandmarksAreFar) {
  Sight sight(1.0);
  for (LandmarkId id = 0; id < 200; ++id) sight.map.landmark(id).position *= 1e4;
  TrackedFrame frame;
  frame.features = sight.scene.See({kTruth.rotation, Eigen::Vector3d::Zero()}, 1.0);
  // Points that are 10,000 times as far are seen as if from the middle.
  frame.landmarks = sight.map.keyframe(0).landmarks;
  const PositionPrior prior{.position = kTruth.translation + Eigen::Vector3d(0.01, 0, 0),
                            .sqrt_information = Eigen::Matrix3d::Identity() / 0.02};
  const Rigid3 refined = RefineFrame(sight.map, kNear, SightingsOf(frame), prior);
  ExpectNear({refined.rotation, prior.position}, kTruth, 0.0101);
  EXPECT_LT((refined.translation - prior.position).norm(), 1e-3);
}

}  // namespace
}  // namespace orb360
