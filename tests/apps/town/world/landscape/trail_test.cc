#include "apps/town/world/landscape/trail.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

TEST(Trail, GoesOnceRoundTheOriginInEvenSteps) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Trail trail(15, Random(seed));
    const std::vector<Vector2f>& points = trail.points();
    double turned = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vector2f& p = points[i];
      const Vector2f& q = points[(i + 1) % points.size()];
      EXPECT_LE(p.norm(), trail.reach());
      const double turn =
          std::remainder(std::atan2(q.y(), q.x()) - std::atan2(p.y(), p.x()), 2 * std::numbers::pi);
      EXPECT_GT(turn, 0);  // a star-shaped curve does not cross itself
      turned += turn;
      EXPECT_LT((q - p).norm(), 0.27F);
      EXPECT_GE((q - p).norm(), i + 1 < points.size() ? 0.25F : 0.0F);
    }
    EXPECT_NEAR(turned, 2 * std::numbers::pi, 1e-4);
    EXPECT_NEAR(trail.Length(), 0.25F * static_cast<float>(points.size()), 0.02F * trail.Length());
  }
}

TEST(Trail, DistanceIsToTheNearestPartOfItsMiddle) {
  const Trail trail(12, Random(3));
  const std::vector<Vector2f>& points = trail.points();
  EXPECT_NEAR(trail.Distance(0.5F * (points[10] + points[11])), 0, 1e-5F);
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector2f p(static_cast<float>(random.Uniform(-25, 25)),
                     static_cast<float>(random.Uniform(-25, 25)));
    float nearest = std::numeric_limits<float>::max();
    for (const Vector2f& q : points) nearest = std::min(nearest, (q - p).norm());
    EXPECT_LE(trail.Distance(p), nearest + 1e-5F);
    EXPECT_GE(trail.Distance(p), nearest - 0.13F);  // half a step
  }
}

}  // namespace
}  // namespace orb360::town
