#include "apps/town/drive/walker.h"

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(Walker, WalksSteadilyOnItsSideOfTheStreetAndOutsideRoundabouts) {
  const StreetPlan plan = PlanStreets({.seed = 3});
  ASSERT_FALSE(plan.roundabouts.empty());
  Random random(5);
  for (size_t street = 0; street < plan.streets.size(); ++street) {
    const Walker walker = DrawWalker(plan, street, random);
    Walker::State before = walker.At(plan, 0);
    for (double time = 0.5; time < 150; time += 0.5) {
      const Walker::State now = walker.At(plan, time);
      EXPECT_LT((now.position - before.position).norm(), 0.5 * std::abs(walker.speed) * 1.8);
      for (const Roundabout& roundabout : plan.roundabouts)
        EXPECT_GT((now.position - roundabout.centre).norm(), roundabout.outer_radius);
      const Vector2d step = now.position - before.position;
      if (now.forward.dot(before.forward) > 0.9) {
        EXPECT_GT(step.normalized().dot(now.forward), 0.8);
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace orb360::town
