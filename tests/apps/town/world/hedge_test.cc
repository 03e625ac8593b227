#include "apps/town/world/hedge.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

TEST(AddHedge, IsAsLongHighAndDeepAsStated) {
  const Materials materials = NamedPlainMaterials();
  constexpr float kLength = 3;
  constexpr float kHeight = 1.4F;
  constexpr float kDepth = 0.9F;
  constexpr float kRagged = 0.33F;  // metres: half the diagonal of a card of leaves
  MeshBuilder builder(materials);
  Random random(5);
  const Panel panel{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  AddHedge(builder, panel, kLength, kHeight, kDepth, random);
  float top = 0;
  for (const Vector3f& p : builder.mesh().positions) {
    EXPECT_GT(p.x(), -kRagged);
    EXPECT_LT(p.x(), kLength + kRagged);
    EXPECT_GT(p.y(), -kRagged);
    EXPECT_LT(p.y(), kDepth + kRagged);
    EXPECT_LT(p.z(), kHeight + kRagged);
    top = std::max(top, p.z());
  }
  EXPECT_GT(top, kHeight - 0.15F);
}

}  // namespace
}  // namespace orb360::town
