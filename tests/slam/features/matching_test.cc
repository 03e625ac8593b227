#include "slam/features/matching.h"

#include <gtest/gtest.h>

#include "slam/features/feature_index.h"
#include "slam/features/hamming.h"
#include "slam/geometry/bearing.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

TEST(Matching, MutualMatchesAreThoseOfBruteForce) {
  SyntheticScene scene(60);
  std::vector<Descriptor> first;
  std::vector<Descriptor> second;
  for (int i = 0; i < 60; ++i) {
    if (i < 45) first.push_back(scene.points[i].descriptor);
    Descriptor noisy = scene.points[i].descriptor;
    noisy[i % 4] ^= 0xFFull << (i % 50);  // up to 8 bits
    if (i >= 15) second.push_back(noisy);
  }
  const std::vector<Match> matches = MatchMutually(first, second, {});
  ASSERT_EQ(matches.size(), 30u);  // points 15 to 44
  for (const Match& match : matches) {
    EXPECT_EQ(match.first, match.second + 15);
    EXPECT_EQ(match.distance, HammingDistance(first[match.first], second[match.second]));
  }
}

TEST(Matching, TwinsFailTheRatioTest) {
  SyntheticScene scene(10);
  std::vector<Descriptor> first;
  for (const SyntheticScene::Point& point : scene.points) first.push_back(point.descriptor);
  std::vector<Descriptor> second = first;
  second.push_back(first[4]);  // seen twice
  const std::vector<Match> matches = MatchMutually(first, second, {});
  EXPECT_EQ(matches.size(), 9u);
  for (const Match& match : matches) EXPECT_NE(match.first, 4);
}

TEST(Matching, NearbyMatchesAreThoseOfBruteForceWithinTheRadius) {
  SyntheticScene scene(300);
  const auto first = scene.See(Rigid3());
  const auto second = scene.See({ExpSo3({0, 0, 0.2}), Eigen::Vector3d::Zero()});
  for (const double radius : {0.05, 0.1, 0.21, 3.2}) {
    std::vector<int> expected;
    for (int i = 0; i < 300; ++i) {
      if (AngleBetween(first->bearings[i], second->bearings[i]) <= radius) expected.push_back(i);
    }
    std::vector<int> found;
    for (const Match& match : MatchNearby(*first, *second, radius, {})) {
      EXPECT_EQ(match.first, match.second);
      found.push_back(match.first);
    }
    EXPECT_EQ(found, expected) << radius;
  }
}

TEST(Matching, NearbyMatchesAreMutual) {
  SyntheticScene scene(2);
  const auto first = scene.See(Rigid3());
  const auto second = scene.See(Rigid3());
  // Both want feature 0 of the second, which prefers the first of them.
  for (const auto& features : {first, second}) {
    features->bearings[1] = features->bearings[0];
    IndexFeatures(features.get());
  }
  first->descriptors[1] = first->descriptors[0];
  first->descriptors[1][0] ^= 1;
  const std::vector<Match> matches = MatchNearby(*first, *second, 0.1, {});
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].first, 0);
  EXPECT_EQ(matches[0].second, 0);
}

}  // namespace
}  // namespace orb360
