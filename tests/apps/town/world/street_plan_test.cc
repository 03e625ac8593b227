#include "apps/town/world/street_plan.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "apps/town/world/lots.h"

namespace orb360::town {
namespace {

StreetPlan PlanOf(uint64_t seed) {
  PlanOptions options;
  options.seed = seed;
  return PlanStreets(options);
}

TEST(StreetPlan, CentrelinesLieInsideTheCarriagewayByHalfItsWidth) {
  const StreetPlan plan = PlanOf(3);
  for (const Street& street : plan.streets) {
    for (const StreetPoint& point : street.points) {
      EXPECT_LE(plan.DistanceToOtherRoads(point.position, plan.streets.size()),
                -point.half_width + 0.05);
    }
  }
}

TEST(StreetPlan, DistanceToRoadOfAStraightStreetIsThatToItsEdge) {
  StreetPlan plan;
  Street street;
  for (int i = 0; i <= 100; ++i)
    street.points.push_back({{i, 0.0}, {1, 0}, static_cast<double>(i), 4.0});
  plan.streets.push_back(street);
  EXPECT_NEAR(plan.DistanceToRoad({50.5, 7}), 3, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({50.5, -1}), -3, 1e-9);
  EXPECT_NEAR(plan.DistanceToRoad({100 + 30, 40}), 46, 1e-9);
}

TEST(StreetPlan, NeighboursOfTheTourShareAStreet) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const StreetPlan plan = PlanOf(seed);
    for (size_t i = 0; i < plan.tour.size(); ++i) {
      const Junction& a = plan.junctions[plan.tour[i]];
      const Junction& b = plan.junctions[plan.tour[(i + 1) % plan.tour.size()]];
      const bool joined = std::any_of(a.arms.begin(), a.arms.end(), [&](const Junction::Arm& arm) {
        return std::any_of(b.arms.begin(), b.arms.end(),
                           [&](const Junction::Arm& other) { return other.street == arm.street; });
      });
      EXPECT_TRUE(joined) << "seed " << seed << " at " << i;
    }
  }
}

TEST(StreetPlan, ArmsPassThroughTheirJunction) {
  const StreetPlan plan = PlanOf(5);
  for (const Junction& junction : plan.junctions) {
    for (const Junction::Arm& arm : junction.arms) {
      EXPECT_NEAR((plan.streets[arm.street].At(arm.station).position - junction.position).norm(), 0,
                  1e-6);
    }
  }
}

TEST(Lots, StandClearOfTheRoads) {
  const StreetPlan plan = PlanOf(7);
  Random random(7);
  const std::vector<Lot> lots = LayOutLots(plan, random);
  EXPECT_GT(lots.size(), 40U);
  for (const Lot& lot : lots) {
    const Vector3f back = Vector3f::UnitZ().cross(lot.right);
    for (const float x : {0.0F, 0.5F, 1.0F}) {
      for (const float y : {0.0F, 0.5F, 1.0F}) {
        const Vector3f p = lot.front_left + x * lot.width * lot.right + y * lot.depth * back;
        EXPECT_GT(plan.DistanceToRoad(p.head<2>().cast<double>()), 1.0);
      }
    }
  }
}

}  // namespace
}  // namespace orb360::town
