#include "slam/pipeline/local_map.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

// Four keyframes in a row; landmark i is seen by keyframes i % 3 and i % 3 + 1 only.
Map MakeChain(const SyntheticScene& scene, SyntheticScene* viewer) {
  Map map;
  const std::vector<Rigid3> poses = Walk(4, {-0.4, 0.0, 0.0});
  for (int k = 0; k < 4; ++k) map.AddKeyframe(k, k, poses[k], viewer->See(poses[k]));
  for (int i = 0; i < 90; ++i) {
    const LandmarkId id = map.AddLandmark(scene.points[i].position, {});
    map.AddObservation(id, i % 3, i);
    map.AddObservation(id, i % 3 + 1, i);
    map.UpdateAppearance(id);
  }
  return map;
}

class LocalMapTest : public testing::Test {
 protected:
  SyntheticScene scene_{90};
  Map map_ = MakeChain(scene_, &scene_);
};

TEST_F(LocalMapTest, HoldsTheLandmarksOfTheReferenceAndItsNearestNeighbours) {
  // Keyframe 0 shares landmarks with keyframe 1 alone, which sees those of i % 3 in {0, 1}.
  const LocalMap local = MakeLocalMap(map_, 0, 10);
  EXPECT_EQ(local.reference, 0);
  ASSERT_EQ(local.landmarks.size(), 60u);
  for (const LocalLandmark& landmark : local.landmarks) {
    EXPECT_NE(landmark.id % 3, 2);
    EXPECT_EQ(landmark.position, scene_.points[landmark.id].position);
  }
  EXPECT_EQ(MakeLocalMap(map_, 1, 10).landmarks.size(), 90u);
  EXPECT_EQ(MakeLocalMap(map_, 1, 0).landmarks.size(), 60u);
}

TEST_F(LocalMapTest, FindsWhatItHoldsAndNothingElse) {
  const LocalMap local = MakeLocalMap(map_, 0, 10);
  for (LandmarkId id = 0; id < 90; ++id) {
    const LocalLandmark* found = local.Find(id);
    ASSERT_EQ(found != nullptr, id % 3 != 2) << id;
    if (found == nullptr) continue;
    EXPECT_EQ(found->id, id);
  }
  EXPECT_EQ(local.Find(90), nullptr);
}

TEST_F(LocalMapTest, CountsTheReferencesLandmarksThatTwoOthersSee) {
  EXPECT_EQ(MakeLocalMap(map_, 0, 10).reference_matches, 0);
  for (int i = 0; i < 12; i += 3) map_.AddObservation(i, 3, i);
  EXPECT_EQ(MakeLocalMap(map_, 0, 10).reference_matches, 4);
}

TEST_F(LocalMapTest, OnlyCornersCanBeTrackedOrBeProvisionalPoints) {
  for (int i = 0; i < 12; i += 3) map_.AddObservation(i, 3, i);
  Keyframe& reference = map_.keyframe(0);
  reference.range_priors.assign(reference.landmarks.size(), {4.0F, 0.1F});
  const size_t free = MakeLocalMap(map_, 0, 10).provisional.size();
  auto features = std::make_shared<Features>(*reference.features);
  ASSERT_EQ(reference.landmarks[0], 0);
  ASSERT_EQ(reference.landmarks[1], kNoId);
  features->keypoints[0].score = 0;
  features->keypoints[1].score = 0;
  reference.features = features;
  const LocalMap local = MakeLocalMap(map_, 0, 10);
  EXPECT_EQ(local.reference_matches, 3);
  EXPECT_EQ(local.provisional.size(), free - 1);
}

TEST_F(LocalMapTest, FeaturesOfTheReferenceWithoutALandmarkAreProvisionalPoints) {
  EXPECT_TRUE(MakeLocalMap(map_, 0, 10).provisional.empty());
  Keyframe& reference = map_.keyframe(0);
  reference.range_priors.assign(reference.landmarks.size(), {});
  int known = 0;
  for (size_t f = 0; f < reference.landmarks.size(); f += 2) {
    reference.range_priors[f] = {4.0F, 0.1F};
    known += reference.landmarks[f] == kNoId;
  }
  const LocalMap local = MakeLocalMap(map_, 0, 10);
  ASSERT_GT(known, 0);
  EXPECT_EQ(local.provisional.size(), static_cast<size_t>(known));
  for (const ProvisionalPoint& point : local.provisional) {
    const Eigen::Vector3d way = point.appearance.position - reference.world_from_camera.translation;
    EXPECT_NEAR(way.norm(), 4.0, 1e-6);
    EXPECT_EQ(point.appearance.id, kNoId);
    EXPECT_FLOAT_EQ(point.range_sigma, 0.1F);
  }
}

}  // namespace
}  // namespace orb360
