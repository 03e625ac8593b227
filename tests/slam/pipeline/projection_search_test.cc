#include "slam/pipeline/projection_search.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

class ProjectionSearchTest : public testing::Test {
 protected:
  ProjectionSearchTest() : map_(scene_.MakeMap(Walk(3, {-0.2, 0.0, 0.0}), 200)) {
    landmarks_ = MakeLocalMap(map_, 2, 10).landmarks;
    features_ = scene_.See(pose_);
  }

  int CountRight(const ProjectionMatches& matches) const {
    int right = 0;
    for (size_t f = 0; f < matches.landmark_of_feature.size(); ++f) {
      const int l = matches.landmark_of_feature[f];
      right += l >= 0 && landmarks_[l].id == static_cast<LandmarkId>(f);
    }
    return right;
  }

  SyntheticScene scene_{300};
  Map map_;
  const Rigid3 pose_{ExpSo3({0.02, -0.05, 0.1}), {-0.6, 0.1, 0.0}};
  std::vector<LocalLandmark> landmarks_;
  std::shared_ptr<Features> features_;
};

TEST_F(ProjectionSearchTest, FindsEachLandmarkWhereThePoseIsRight) {
  const ProjectionMatches matches = SearchByProjection(*features_, pose_, landmarks_, {}, {});
  EXPECT_GT(CountRight(matches), 190);
  EXPECT_EQ(matches.num_matches, CountRight(matches));
}

TEST_F(ProjectionSearchTest, ReachesNoFartherThanItsRadius) {
  const Rigid3 turned{pose_.rotation * ExpSo3({0.0, 0.0, 0.1}), pose_.translation};
  const auto count = [&](double radius) {
    return SearchByProjection(*features_, turned, landmarks_, {}, {.radius = radius}).num_matches;
  };
  EXPECT_GT(count(0.11), 190);
  // Only directions near the axis of the turn move less.
  EXPECT_LT(count(0.02), 20);
}

TEST_F(ProjectionSearchTest, LeavesTakenFeaturesAlone) {
  std::vector<uint8_t> taken(features_->size(), 0);
  std::fill_n(taken.begin(), 100, 1);
  const ProjectionMatches matches = SearchByProjection(*features_, pose_, landmarks_, taken, {});
  for (int f = 0; f < 100; ++f) EXPECT_EQ(matches.landmark_of_feature[f], -1);
  EXPECT_GT(CountRight(matches), 90);
}

TEST_F(ProjectionSearchTest, ExpectsOnlyWhatIsSeenFromItsUsualSideAndDistance) {
  landmarks_[0].mean_direction = -landmarks_[0].mean_direction;
  landmarks_[1].max_range *= 1e-3;  // was seen from a thousandth of the distance
  const ProjectionMatches matches = SearchByProjection(*features_, pose_, landmarks_, {}, {});
  EXPECT_FALSE(matches.expected[0]);
  EXPECT_FALSE(matches.expected[1]);
  EXPECT_GT(std::count(matches.expected.begin(), matches.expected.end(), 1), 190);
}

TEST_F(ProjectionSearchTest, OfTwoLandmarksTheNearerDescriptorGetsTheFeature) {
  LocalLandmark rival = landmarks_[5];
  rival.id = 1000;
  rival.descriptor[0] ^= 0xFF;
  landmarks_.insert(landmarks_.begin(), rival);
  const ProjectionMatches matches = SearchByProjection(*features_, pose_, landmarks_, {}, {});
  EXPECT_EQ(matches.landmark_of_feature[5], 6);
}

}  // namespace
}  // namespace orb360
