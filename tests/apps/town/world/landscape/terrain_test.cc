#include "apps/town/world/landscape/terrain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "apps/town/render/ray_scene.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

const TerrainOptions kRough{.seed = 5, .hills = 3, .hill_size = 40, .bumps = 0.4F, .mountains = 50};

TEST(Terrain, GroundIsWhereItsHeightSaysAndHasNoHoles) {
  const Trail trail(10, Random(2));
  const Terrain terrain(trail, kRough);
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  terrain.AddGround(30, {0, 0, 0, 0}, builder);
  Scenery scenery;
  scenery.fixed = builder.mesh();
  scenery.fixed.PartitionCutouts(materials);
  scenery.palette = materials;
  const RayScene scene(scenery);
  Random random(7);
  constexpr float kHigh = 500;
  for (int i = 0; i < 2000; ++i) {
    const auto half = i % 2 == 0 ? 29.5 : 700.0;
    const Vector2f p(static_cast<float>(random.Uniform(-half, half)),
                     static_cast<float>(random.Uniform(-half, half)));
    const float down = DistanceAlong(scene, {p.x(), p.y(), kHigh}, -Vector3f::UnitZ(), 2 * kHigh);
    ASSERT_LT(down, 2 * kHigh) << p.transpose();
    // Between vertices the mesh is flat; far away it is coarse.
    EXPECT_NEAR(kHigh - down, terrain.Height(p), i % 2 == 0 ? 0.15F : 15) << p.transpose();
  }
}

TEST(Terrain, IsSmootherOnTheTrailThanBesideIt) {
  const Trail trail(14, Random(4));
  const Terrain terrain(trail, kRough);
  double on = 0;
  double beside = 0;
  const std::vector<Vector2f>& points = trail.points();
  for (size_t i = 2; i + 2 < points.size(); ++i) {
    const auto bend = [&](const Vector2f& aside) {
      return std::abs(terrain.Height(points[i - 2] + aside) -
                      2 * terrain.Height(points[i] + aside) +
                      terrain.Height(points[i + 2] + aside));
    };
    on += bend({0, 0});
    beside += bend({points[i].normalized() * 5});
  }
  EXPECT_LT(on, 0.4 * beside);
}

}  // namespace
}  // namespace orb360::town
