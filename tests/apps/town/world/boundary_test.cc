#include "apps/town/world/boundary.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

Lot LotAt(float x) {
  Lot lot;
  lot.front_left = {x, 2, 0.1F};
  lot.right = {1, 0, 0};
  lot.width = 8;
  lot.depth = 10;
  return lot;
}

size_t TrianglesBetween(float gap) {
  const Materials materials = NamedPlainMaterials();
  MeshBuilder builder(materials);
  AddBoundaries({LotAt(0), LotAt(8 + gap)}, Random(1), builder);
  for (const Vector3f& p : builder.mesh().positions) {
    EXPECT_GT(p.x(), 8 - 0.4F);
    EXPECT_LT(p.x(), 8 + gap + 0.4F);
  }
  return builder.mesh().triangles.size();
}

TEST(AddBoundaries, CloseGapsThatANeighbourBounds) {
  EXPECT_GT(TrianglesBetween(3), 0U);
  EXPECT_EQ(TrianglesBetween(0.02F), 0U);  // wall to wall
  EXPECT_EQ(TrianglesBetween(30), 0U);     // another street comes in between
}

}  // namespace
}  // namespace orb360::town
