#include "apps/town/drive/route_walk.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(RouteWalk, GoesStraightAtItsSpeed) {
  const RouteWalk walk({{1, 2}, {1, 12}}, 1.25);
  EXPECT_NEAR(walk.duration(), 8, 0.1);
  const WalkState a = walk.At(2);
  const WalkState b = walk.At(6);
  EXPECT_NEAR(a.position.x(), 1, 1e-6);
  EXPECT_NEAR(b.position.y() - a.position.y(), 5, 1e-3);
  EXPECT_NEAR(b.distance - a.distance, 5, 1e-3);
  EXPECT_NEAR(a.heading, std::numbers::pi / 2, 1e-6);
}

TEST(RouteWalk, IsSlowerInSharpBendsAndTurnsWithoutJumps) {
  const RouteWalk walk({{0, 0}, {5, 0}, {5, 5}, {0, 5}, {0, 0}, {5, 0}}, 1);
  double slowest = 10;
  double fastest = 0;
  for (double time = 1; time < walk.duration() - 1; time += 0.05) {
    const WalkState a = walk.At(time);
    const WalkState b = walk.At(time + 0.05);
    const double speed = (b.position - a.position).norm() / 0.05;
    slowest = std::min(slowest, speed);
    fastest = std::max(fastest, speed);
    EXPECT_LT(std::abs(b.heading - a.heading), 0.15);
  }
  EXPECT_LT(slowest, 0.6);
  EXPECT_NEAR(fastest, 1, 0.02);
  EXPECT_NEAR(walk.At(walk.duration()).heading, 2 * std::numbers::pi, 0.05);
}

TEST(RouteWalk, RoutesAreResampledEvenly) {
  const std::vector<Vector2f> points = ResampleRoute({{0, 0}, {0.33F, 0}, {0.33F, 1}});
  EXPECT_EQ(points.size(), 27U);  // 1.33 m in steps of 0.05 m
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(points[i].x(), 0.05F * static_cast<float>(i), 1e-6F);
  EXPECT_NEAR(points[10].y(), 0.5F - 0.33F, 1e-5F);
}

}  // namespace
}  // namespace orb360::town
