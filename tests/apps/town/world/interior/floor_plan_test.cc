#include "apps/town/world/interior/floor_plan.h"

#include <set>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(FloorPlan, HasDisjointRoomsThatDoorwaysLink) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const auto kind = static_cast<BuildingKind>(seed % kBuildingKinds);
    const FloorPlan plan = PlanFloor(kind, Random(seed));
    std::set<size_t> linked = {0};
    for (size_t round = 0; round < plan.rooms.size(); ++round) {
      for (const Doorway& way : plan.doorways) {
        if (linked.contains(way.first)) linked.insert(way.second);
        if (linked.contains(way.second)) linked.insert(way.first);
      }
    }
    EXPECT_EQ(linked.size(), plan.rooms.size()) << seed;
    for (size_t i = 0; i < plan.rooms.size(); ++i) {
      const Room& room = plan.rooms[i];
      EXPECT_GE(room.height, 1.9F) << seed;
      EXPECT_LE(room.height + room.rise, 15) << seed;
      for (size_t k = 0; k < i; ++k)
        EXPECT_FALSE(room.area.Overlaps(plan.rooms[k].area)) << seed << ": " << i << ", " << k;
    }
  }
}

TEST(FloorPlan, HasWallsAroundItsHolesAndNothingBeforeItsDoors) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const FloorPlan plan =
        PlanFloor(static_cast<BuildingKind>(seed % kBuildingKinds), Random(seed));
    for (const Room& room : plan.rooms) {
      for (const auto& holes : room.holes) {
        for (size_t i = 0; i < holes.size(); ++i) {
          EXPECT_LT(holes[i].high, room.height) << seed;
          EXPECT_LT(holes[i].low, holes[i].high) << seed;
          if (i == 0) continue;
          EXPECT_GT(holes[i].begin, holes[i - 1].end) << seed;
        }
      }
      for (const Doorway& way : plan.doorways) {
        for (const Area& block : room.blocks) {
          EXPECT_FALSE(block.Overlaps(way.Floor().Grown(0.2F))) << seed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace orb360::town
