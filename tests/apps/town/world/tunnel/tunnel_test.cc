#include "apps/town/world/tunnel/tunnel.h"

#include <set>

#include <gtest/gtest.h>

#include "apps/town/image/random.h"
#include "apps/town/render/ray_scene.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

constexpr float kFar = 300;  // metres

Tunnel PlainTunnel(uint64_t seed) {
  return BuildTunnel(seed, static_cast<TunnelKind>(seed % kTunnelKinds), PlainLandscapeMaterials());
}

TEST(Tunnel, SeedsGiveAllKinds) {
  std::set<TunnelKind> kinds;
  for (uint64_t seed = 0; seed < 40; ++seed) kinds.insert(KindOfTunnel(seed));
  EXPECT_EQ(kinds.size(), static_cast<size_t>(kTunnelKinds));
}

TEST(TunnelSlow, TheTrailIsFreeAndItsFloorIsWhereItIsSaidToBe) {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    const Tunnel tunnel = PlainTunnel(seed);
    const RayScene scene(tunnel.scenery);
    const std::vector<Vector2f>& points = tunnel.trail.points();
    double mean = 0;  // height above the floor that is met
    for (size_t i = 0; i < points.size(); ++i) {
      // A little aside, since a ray exactly along an edge may miss both of its triangles.
      const Vector2f p = points[i] + Vector2f(0.013F, 0.007F);
      const Vector3f at(p.x(), p.y(), tunnel.floor(p) + 0.9F);
      const float up = DistanceAlong(scene, at, Vector3f::UnitZ(), kFar);
      EXPECT_GT(0.9F + up, tunnel.head_room + 0.1) << seed;
      // Sleepers lie on it; loose rock lies beside the trail.
      const float down = DistanceAlong(scene, at, -Vector3f::UnitZ(), kFar);
      EXPECT_NEAR(down, 0.9F, 0.17F) << seed;
      mean += down / static_cast<double>(points.size());
      const Vector2f next = points[(i + 1) % points.size()] + Vector2f(0.013F, 0.007F);
      for (const double height : {0.3, 1.2, tunnel.head_room}) {
        const Vector3f from(p.x(), p.y(), tunnel.floor(p) + static_cast<float>(height));
        const Vector3f to(next.x(), next.y(), tunnel.floor(next) + static_cast<float>(height));
        EXPECT_EQ(DistanceAlong(scene, from, to - from, 1), 1) << seed << " " << height;
      }
    }
    EXPECT_NEAR(mean, 0.9, 0.025) << seed;  // a little less with sleepers
  }
}

TEST(TunnelSlow, IsClosed) {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    const Tunnel tunnel = PlainTunnel(seed);
    const RayScene scene(tunnel.scenery);
    Random random(seed);
    for (int i = 0; i < 4000; ++i) {
      const std::vector<Vector2f>& points = tunnel.trail.points();
      const Vector2f& p = points[static_cast<size_t>(random.Int(static_cast<int>(points.size())))];
      const Vector3f direction(static_cast<float>(random.Gaussian()),
                               static_cast<float>(random.Gaussian()),
                               static_cast<float>(random.Gaussian()));
      EXPECT_LT(
          DistanceAlong(scene, {p.x(), p.y(), tunnel.floor(p) + 1}, direction.normalized(), kFar),
          kFar)
          << seed;
    }
  }
}

TEST(TunnelSlow, IsLitByLampsThatShineDownward) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    const Tunnel tunnel = PlainTunnel(seed);
    EXPECT_GE(tunnel.scenery.lamps.size(), 5U) << seed;
    for (const Lamp& lamp : tunnel.scenery.lamps) {
      EXPECT_LT(lamp.first_side.cross(lamp.second_side).normalized().z(), -0.99F) << seed;
      const Vector2f at = lamp.Centre().head<2>();
      EXPECT_GT(lamp.Centre().z(), tunnel.floor(at) + tunnel.head_room) << seed;
    }
  }
}

}  // namespace
}  // namespace orb360::town
