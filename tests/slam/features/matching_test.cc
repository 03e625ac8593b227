#include "slam/features/matching.h"

#include <gtest/gtest.h>

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

TEST(Matching, NearbyMatchesStayWithinTheRadius) {
  SyntheticScene scene(300);
  const auto first = scene.See(Rigid3());
  const Rigid3 turned{ExpSo3({0, 0, 0.2}), Eigen::Vector3d::Zero()};
  const auto second = scene.See(turned);
  EXPECT_GT(MatchNearby(*first, *second, 0.21, {}).size(), 290u);
  for (const Match& match : MatchNearby(*first, *second, 0.1, {})) {
    EXPECT_LT(AngleBetween(first->bearings[match.first], second->bearings[match.second]), 0.2);
    EXPECT_EQ(match.first, match.second);
  }
  EXPECT_LT(MatchNearby(*first, *second, 0.05, {}).size(), 150u);
}

}  // namespace
}  // namespace orb360
