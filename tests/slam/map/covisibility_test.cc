#include "slam/map/covisibility.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

TEST(FindCovisibilityEdges, EachPairThatSharesEnoughIsFoundOnce) {
  SyntheticScene scene(40);
  Map map = scene.MakeMap(Walk(3, {-0.5, 0.1, 0.0}), 30);  // every keyframe sees all 30
  for (LandmarkId id = 0; id < 12; ++id) map.RemoveObservation(id, 2);
  const std::vector<CovisibilityEdge> all = FindCovisibilityEdges(map, 1);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].first, 0);
  EXPECT_EQ(all[0].second, 1);
  EXPECT_EQ(all[0].shared, 30);
  EXPECT_EQ(all[1].second, 2);
  EXPECT_EQ(all[1].shared, 18);
  EXPECT_EQ(all[2].first, 1);
  EXPECT_EQ(FindCovisibilityEdges(map, 18).size(), 3u);
  EXPECT_EQ(FindCovisibilityEdges(map, 19).size(), 1u);
}

TEST(MarkCovisible, ReachesTwoEdgesOfTheGraphAndNoFarther) {
  SyntheticScene scene(40);
  Map map = scene.MakeMap(Walk(4, {-0.5, 0.1, 0.0}), 30);
  // A chain: ten landmarks are left to each pair of neighbours.
  for (LandmarkId id = 0; id < 30; ++id) {
    for (KeyframeId keyframe = 0; keyframe < 4; ++keyframe) {
      const KeyframeId first = id / 10;
      if (keyframe != first && keyframe != first + 1) map.RemoveObservation(id, keyframe);
    }
  }
  EXPECT_EQ(MarkCovisible(map, 0, 10), (std::vector<uint8_t>{1, 1, 1, 0}));
  EXPECT_EQ(MarkCovisible(map, 1, 10), (std::vector<uint8_t>{1, 1, 1, 1}));
  EXPECT_EQ(MarkCovisible(map, 0, 11), (std::vector<uint8_t>{1, 0, 0, 0}));
}

}  // namespace
}  // namespace orb360
