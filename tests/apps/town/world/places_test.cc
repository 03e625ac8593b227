#include "apps/town/world/places.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "apps/town/drive/lap.h"
#include "apps/town/world/lots.h"

namespace orb360::town {
namespace {

StreetPlan PlanOf(uint64_t seed) {
  return PlanStreets({.seed = seed, .columns = 4, .rows = 3, .spacing = 54, .tour_blocks = 3});
}

TEST(Places, LargerTownsHaveAnAvenueARoundaboutAParkAndABridge) {
  size_t roundabouts = 0;
  size_t bridges = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    EXPECT_EQ(std::count_if(plan.streets.begin(), plan.streets.end(),
                            [](const Street& street) { return street.median > 0; }),
              1);
    EXPECT_EQ(plan.parks.size(), 1U);
    roundabouts += plan.roundabouts.size();
    bridges += plan.bridges.size();
  }
  EXPECT_GE(roundabouts, 8U);
  EXPECT_GE(bridges, 8U);
}

TEST(Places, IslandsAreNotCarriagewayAndLieWithinIt) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    EXPECT_FALSE(plan.islands.empty());
    for (const Island& island : plan.islands) {
      for (const Vector2d& p : island.spine) {
        EXPECT_NEAR(plan.DistanceToRoad(p), island.radius, 1e-9);
        EXPECT_LT(plan.DistanceToOtherRoads(p, plan.streets.size()), -island.radius - 2.5);
      }
    }
  }
}

TEST(Places, DistanceToRoadNearAMedianIsThatToItsKerb) {
  StreetPlan plan;
  Street street;
  for (int i = 0; i <= 100; ++i)
    street.points.push_back({{i, 0.0}, {1, 0}, static_cast<double>(i), 8.0});
  plan.streets.push_back(street);
  plan.islands.push_back({{{30, 0}, {50, 0}, {70, 0}}, 40, 1.5});
  EXPECT_NEAR(plan.DistanceToRoad({40, 0.5}), 1.0, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({60, -2.5}), -1.0, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({73.5, 0}), -2.0, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({40, 7}), -1.0, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({10, 0}), -8.0, 1e-9);
}

TEST(Places, LapsGoRoundTheIslandCounterClockwiseAndSlowly) {
  int rounds = 0;
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    for (const Roundabout& roundabout : plan.roundabouts) {
      const std::vector<size_t> back(plan.tour.rbegin(), plan.tour.rend());
      for (const std::vector<size_t>& tour : {plan.tour, back}) {
        const Lap lap(plan, tour, {.seed = seed});
        for (double s = 0; s < lap.length(); s += 0.5) {
          const RoadPose pose = lap.PoseAt(s);
          const Vector2d arm = pose.position - roundabout.centre;
          if (arm.norm() > roundabout.outer_radius) continue;
          ++rounds;
          EXPECT_GT(arm.norm(), roundabout.island_radius + 1.2) << "seed " << seed;
          EXPECT_GT(arm.x() * pose.forward.y() - arm.y() * pose.forward.x(), 0)
              << "clockwise, seed " << seed;
          EXPECT_LT(lap.At(lap.TimeAt(s)).speed, 9.5);
        }
      }
    }
  }
  EXPECT_GT(rounds, 100);
}

TEST(Places, LapsStayOnTheCarriageway) {
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    const Lap lap(plan, plan.tour, {.seed = seed});
    for (double s = 0; s < lap.length(); s += 0.5)
      EXPECT_LT(plan.DistanceToRoad(lap.PoseAt(s).position), -0.75) << "seed " << seed;
  }
}

TEST(Places, LotsKeepClearOfRoadsParksAndBridges) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    Random random(seed);
    for (const Lot& lot : LayOutLots(plan, random)) {
      const Vector3f back = Vector3f::UnitZ().cross(lot.right);
      for (float x = 0; x <= 1; x += 0.25F) {
        for (float y = 0; y <= 1; y += 0.25F) {
          const Vector3f corner = lot.front_left + x * lot.width * lot.right + y * lot.depth * back;
          const Vector2d p = corner.head<2>().cast<double>();
          EXPECT_GT(plan.DistanceToRoad(p), 1.0);
          EXPECT_FALSE(plan.parks.front().Contains(p));
          for (const Bridge& bridge : plan.bridges) {
            const Vector2d d = p - bridge.centre;
            const Vector2d across(-bridge.along.y(), bridge.along.x());
            EXPECT_FALSE(std::abs(d.dot(bridge.along)) < bridge.half_width - 0.5 &&
                         std::abs(d.dot(across)) < bridge.reach - 0.5);
          }
        }
      }
    }
  }
}

TEST(Places, BridgesLeaveStreetAndPavementsOpenAndBlockNoOtherStreet) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    for (const Bridge& bridge : plan.bridges) {
      const Vector2d across(-bridge.along.y(), bridge.along.x());
      for (double x = -bridge.half_width; x <= bridge.half_width; x += 0.5) {
        for (const double side : {-1.0, 1.0}) {
          for (double y = bridge.half_opening; y <= bridge.reach; y += 0.5) {
            const Vector2d p = bridge.centre + x * bridge.along + side * y * across;
            EXPECT_GT(plan.DistanceToRoad(p), 1.5) << "seed " << seed;
          }
        }
      }
    }
  }
}

TEST(Park, ContainsWhatLiesWithinItsOutline) {
  Park park;
  park.outline = {{0, 0}, {10, 0}, {10, 6}, {5, 3}, {0, 6}};
  EXPECT_TRUE(park.Contains({1, 1}));
  EXPECT_TRUE(park.Contains({9, 4}));
  EXPECT_FALSE(park.Contains({5, 4}));
  EXPECT_FALSE(park.Contains({11, 1}));
  EXPECT_FALSE(park.Contains({-1, 1}));
}

}  // namespace
}  // namespace orb360::town
