#include "slam/pipeline/landmark_counts.h"

#include <gtest/gtest.h>

#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

Map SmallMap() {
  SyntheticScene scene(40);
  return scene.MakeMap(Walk(4, {-0.5, 0.1, 0.0}), 30);
}

TEST(LandmarkCounts, ReachTheLandmarksOnceAndFollowMergedOnes) {
  Map map = SmallMap();
  const int visible = map.landmark(5).visible;
  const int found = map.landmark(5).found;
  LandmarkCounts counts;
  TrackResult result;
  result.expected = {5, 6};
  result.landmarks = {kNoId, 6, kNoId};  // by feature
  counts.Add(result);
  counts.Add(result);
  map.MergeLandmark(6, 5);  // in the meantime
  const int merged_visible = map.landmark(5).visible;
  const int merged_found = map.landmark(5).found;
  EXPECT_GE(merged_visible, visible);
  EXPECT_GE(merged_found, found);
  counts.MoveTo(&map);
  EXPECT_EQ(map.landmark(5).visible, merged_visible + 4);
  EXPECT_EQ(map.landmark(5).found, merged_found + 2);
  counts.MoveTo(&map);
  EXPECT_EQ(map.landmark(5).visible, merged_visible + 4);
}

TEST(LandmarkCounts, LeaveOutRemovedLandmarksAndFollowNewIds) {
  Map map = SmallMap();
  map.RemoveLandmark(3);
  const int visible = map.landmark(7).visible;
  LandmarkCounts counts;
  TrackResult result;
  result.expected = {1, 5};
  counts.Add(result);
  counts.Shift(2);  // to 3, which is gone, and 7
  counts.MoveTo(&map);
  EXPECT_EQ(map.landmark(7).visible, visible + 1);
}

}  // namespace
}  // namespace orb360
