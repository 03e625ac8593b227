#include "apps/town/world/landscape/landscape.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

Landscape PlainLandscape(uint64_t seed) {
  return BuildLandscape(seed, static_cast<LandscapeKind>(seed % kLandscapeKinds),
                        PlainLandscapeMaterials());
}

TEST(Landscape, SeedsGiveAllKinds) {
  std::set<LandscapeKind> kinds;
  for (uint64_t seed = 0; seed < 40; ++seed) kinds.insert(KindOfLandscape(seed));
  EXPECT_EQ(kinds.size(), static_cast<size_t>(kLandscapeKinds));
}

TEST(LandscapeSlow, NothingStandsOnTheTrailOrHangsLowOverIt) {
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const Landscape landscape = PlainLandscape(seed);
    size_t near = 0;
    for (const Instance& instance : landscape.scenery.instances) {
      const Vector3f& at = instance.world_from_model.translation();
      if (landscape.trail.Distance(at.head<2>()) > 12) continue;
      for (const Vector3f& p : landscape.scenery.models[instance.model].positions) {
        const Vector3f q = instance.world_from_model * p;
        const float above = q.z() - landscape.Height(q.head<2>());
        if (above < 0 || above > kFreeHeight) continue;
        ++near;
        ASSERT_GE(landscape.trail.Distance(q.head<2>()), kFreeWidth - 1e-3F) << seed;
      }
    }
    EXPECT_GT(near, 1000U) << seed;
  }
}

TEST(LandscapeSlow, ThingsStandOnTheGround) {
  const Landscape landscape = PlainLandscape(1);
  for (const Instance& instance : landscape.scenery.instances) {
    const Vector3f& at = instance.world_from_model.translation();
    EXPECT_NEAR(at.z(), landscape.Height(at.head<2>()), 0.4F);  // boulders are sunk
  }
}

TEST(LandscapeSlow, TheSameSeedGivesTheSameScenery) {
  const Landscape a = PlainLandscape(2);
  const Landscape b = PlainLandscape(2);
  ASSERT_EQ(a.scenery.instances.size(), b.scenery.instances.size());
  EXPECT_EQ(a.scenery.fixed.positions, b.scenery.fixed.positions);
  for (size_t i = 0; i < a.scenery.models.size(); ++i)
    EXPECT_EQ(a.scenery.models[i].positions, b.scenery.models[i].positions);
}

}  // namespace
}  // namespace orb360::town
