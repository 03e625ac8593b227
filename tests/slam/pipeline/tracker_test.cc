#include "slam/pipeline/tracker.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

class TrackerTest : public testing::Test {
 protected:
  TrackerTest() : map_(scene_.MakeMap(Walk(3, {-0.3, 0.1, 0.0}), 400)) {
    local_ = MakeLocalMap(map_, 2, 10);
    last_.features = map_.keyframe(2).features;
    last_.world_from_camera = map_.keyframe(2).world_from_camera;
    last_.landmarks = map_.keyframe(2).landmarks;
  }

  SyntheticScene scene_{500};
  Map map_;
  LocalMap local_;
  TrackedFrame last_;
  const Rigid3 truth_{ExpSo3({0.05, -0.05, 0.12}), {-0.85, 0.35, 0.05}};
};

void ExpectNear(const Rigid3& found, const Rigid3& truth) {
  // 400 bearings of 1 to 3 mrad to points about 10 away, give or take five deviations.
  EXPECT_LT(found.rotation.angularDistance(truth.rotation), 1e-3);
  EXPECT_LT((found.translation - truth.translation).norm(), 0.01);
}

// A map of few landmarks, and what is known roughly of the ranges of the other features.
TEST_F(TrackerTest, RoughRangesOfOtherFeaturesMakeThePoseBetter) {
  double plain_error = 0;
  double provisional_error = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Map map = scene_.MakeMap(Walk(3, {-0.3, 0.1, 0.0}), 45);
    TrackedFrame last{.features = map.keyframe(2).features,
                      .world_from_camera = map.keyframe(2).world_from_camera,
                      .landmarks = map.keyframe(2).landmarks};
    const auto features = scene_.See(truth_);
    const auto error = [&] {
      const auto result = TrackFromPrediction(*features, last.world_from_camera, last,
                                              MakeLocalMap(map, 2, 10), scene_.sigma, {});
      EXPECT_TRUE(result.has_value());
      // Only landmarks are counted.
      EXPECT_LE(result->num_inliers, 45);
      return result ? (result->world_from_camera.translation - truth_.translation).norm() : 1.0;
    };
    plain_error += error();
    Keyframe& reference = map.keyframe(2);
    for (const SyntheticScene::Point& point : scene_.points) {
      const double range = (point.position - reference.world_from_camera.translation).norm();
      const double noisy = range * std::exp(0.1 * scene_.random.Uniform(-1.7, 1.7));
      reference.range_priors.push_back({static_cast<float>(noisy), 0.1F});
    }
    provisional_error += error();
  }
  EXPECT_LT(provisional_error, 0.8 * plain_error);
}

TEST_F(TrackerTest, FindsThePoseAndItsLandmarksFromARoughPrediction) {
  const auto features = scene_.See(truth_);
  const auto result =
      TrackFromPrediction(*features, last_.world_from_camera, last_, local_, scene_.sigma, {});
  ASSERT_TRUE(result.has_value());
  ExpectNear(result->world_from_camera, truth_);
  EXPECT_GT(result->num_inliers, 320);
  for (int f = 0; f < features->size(); ++f) {
    if (result->landmarks[f] != kNoId) {
      EXPECT_EQ(result->landmarks[f], f);
    }
  }
}

TEST_F(TrackerTest, FindsThePoseWhereThePredictionIsFarOff) {
  const Rigid3 jerk{ExpSo3({0.0, 0.1, 0.15}), {0.5, -0.5, 0.0}};
  const auto result = TrackFromPrediction(*scene_.See(truth_), last_.world_from_camera * jerk,
                                          last_, local_, scene_.sigma, {});
  ASSERT_TRUE(result.has_value());
  ExpectNear(result->world_from_camera, truth_);
  EXPECT_GT(result->num_inliers, 320);
}

TEST_F(TrackerTest, FindsThePoseWithAHandfulOfLandmarksLeft) {
  for (int f = 12; f < static_cast<int>(last_.landmarks.size()); ++f) last_.landmarks[f] = kNoId;
  const auto result = TrackFromPrediction(*scene_.See(truth_), last_.world_from_camera, last_,
                                          local_, scene_.sigma, {});
  ASSERT_TRUE(result.has_value());
  ExpectNear(result->world_from_camera, truth_);
  EXPECT_GT(result->num_inliers, 320);
}

TEST_F(TrackerTest, FindsThePoseWithoutAnyPrediction) {
  const Rigid3 turned{ExpSo3({0.4, 1.2, -2.0}), {-0.5, 0.3, 0.2}};
  const auto result = TrackWithoutPrediction(*scene_.See(turned), local_, scene_.sigma, {});
  ASSERT_TRUE(result.has_value());
  ExpectNear(result->world_from_camera, turned);
}

TEST_F(TrackerTest, GivesUpWhereNothingMatches) {
  SyntheticScene other(900);
  other.points.erase(other.points.begin(), other.points.begin() + 500);
  const auto features = other.See(truth_);
  EXPECT_FALSE(TrackFromPrediction(*features, truth_, last_, local_, scene_.sigma, {}).has_value());
  EXPECT_FALSE(TrackWithoutPrediction(*features, local_, scene_.sigma, {}).has_value());
}

TEST_F(TrackerTest, LeavesOutLandmarksThatMoved) {
  for (int i = 0; i < 80; ++i) scene_.points[i].position += Eigen::Vector3d(0.0, 0.0, 1.5);
  const auto result = TrackFromPrediction(*scene_.See(truth_), last_.world_from_camera, last_,
                                          local_, scene_.sigma, {});
  ASSERT_TRUE(result.has_value());
  ExpectNear(result->world_from_camera, truth_);
  EXPECT_LT(std::count_if(result->landmarks.begin(), result->landmarks.begin() + 80,
                          [](LandmarkId id) { return id != kNoId; }),
            8);
}

}  // namespace
}  // namespace orb360
