#include "slam/pipeline/reconstruction.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(Renumber, APlacementFollowsItsMapItsKeyframeAndItsLandmarks) {
  const MapRenumbering maps{{2, 0, 1}, 1, 30, 400};
  Placement of_shifted{0.5, 1, 7, {}, {{11, {1, 0, 0}, 0.01f}, {12, {0, 1, 0}, 0.01f}}};
  Renumber(maps, &of_shifted);
  EXPECT_EQ(of_shifted.map, 0);
  EXPECT_EQ(of_shifted.reference, 37);
  EXPECT_EQ(of_shifted.sightings[0].landmark, 411);
  EXPECT_EQ(of_shifted.sightings[1].landmark, 412);
  Placement of_other{0.6, 2, 7, {}, {{11, {1, 0, 0}, 0.01f}}};
  Renumber(maps, &of_other);
  EXPECT_EQ(of_other.map, 1);
  EXPECT_EQ(of_other.reference, 7);
  EXPECT_EQ(of_other.sightings[0].landmark, 11);
}

}  // namespace
}  // namespace orb360
