#include "apps/town/world/road_details.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

TEST(AddRoadDetails, LieFlatOnTheCarriageways) {
  PlanOptions options;
  options.seed = 4;
  const StreetPlan plan = PlanStreets(options);
  const Materials materials = NamedPlainMaterials();
  MeshBuilder builder(materials);
  AddRoadDetails(plan, Random(4), builder);
  EXPECT_GT(builder.mesh().triangles.size(), 100U);
  for (const Vector3f& p : builder.mesh().positions) {
    const Vector2d q = p.head<2>().cast<double>();
    EXPECT_LT(plan.DistanceToRoad(q), 0.02);
    const double above = p.z() - plan.Height(q);
    EXPECT_GT(above, 0.0007);
    EXPECT_LT(above, 0.002);  // below the road paint
  }
}

}  // namespace
}  // namespace orb360::town
