#include "apps/town/world/tunnel/surface_nets.h"

#include <map>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

/// A hollow ball of that radius about the origin.
ValueGrid Ball(float radius, float cell) {
  ValueGrid grid;
  grid.cell = cell;
  const int side = 2 * static_cast<int>(radius / cell + 3) + 1;
  const float half = 0.5F * cell * static_cast<float>(side - 1);
  grid.origin = Vector3f(-half, -half, -half) + Vector3f(0.013F, 0.007F, 0.021F);
  grid.size = {side, side, side};
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) grid.values.push_back(grid.At(x, y, z).norm() - radius);
    }
  }
  return grid;
}

TEST(SurfaceNets, ABallIsRoundAndSeenFromWithin) {
  const Surface surface = SurfaceNets(Ball(2, 0.1F));
  for (const Vector3f& p : surface.positions) EXPECT_NEAR(p.norm(), 2, 0.02F);
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Vector3f& p = surface.positions[a];
    const Vector3f across = (surface.positions[b] - p).cross(surface.positions[c] - p);
    EXPECT_LE(across.dot(p), 0);  // towards the middle, where it is hollow
    area += 0.5 * across.norm();
  }
  EXPECT_NEAR(area, 4 * std::numbers::pi * 4, 0.02 * 4 * std::numbers::pi * 4);
}

TEST(SurfaceNets, IsClosed) {
  const Surface surface = SurfaceNets(Ball(1, 0.17F));
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& t : surface.triangles) {
    for (size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
}

TEST(SurfaceNets, WithoutAChangeOfSignThereIsNoSurface) {
  ValueGrid grid = Ball(1, 0.2F);
  for (float& value : grid.values) value = 1;
  EXPECT_TRUE(SurfaceNets(grid).positions.empty());
}

}  // namespace
}  // namespace orb360::town
