#include "slam/pipeline/frame_anchor.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(Renumber, AnAnchorFollowsItsMapItsKeyframeAndItsLandmarks) {
  const MapRenumbering maps{{2, 0, 1}, 1, 30, 400};
  FrameAnchor of_shifted{.timestamp = 0.5,
                         .map = 1,
                         .reference = 7,
                         .sightings = {{11, {1, 0, 0}, 0.01f}, {12, {0, 1, 0}, 0.01f}}};
  Renumber(maps, &of_shifted);
  EXPECT_EQ(of_shifted.map, 0);
  EXPECT_EQ(of_shifted.reference, 37);
  EXPECT_EQ(of_shifted.sightings[0].landmark, 411);
  EXPECT_EQ(of_shifted.sightings[1].landmark, 412);
  FrameAnchor of_other{
      .timestamp = 0.6, .map = 2, .reference = 7, .sightings = {{11, {1, 0, 0}, 0.01f}}};
  Renumber(maps, &of_other);
  EXPECT_EQ(of_other.map, 1);
  EXPECT_EQ(of_other.reference, 7);
  EXPECT_EQ(of_other.sightings[0].landmark, 11);
}

}  // namespace
}  // namespace orb360
