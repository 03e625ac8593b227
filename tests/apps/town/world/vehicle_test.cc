#include "apps/town/world/vehicle.h"

#include <set>

#include <gtest/gtest.h>

#include "apps/town/world/vehicle_shape.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

constexpr float kPlate = 0.015F;   // metres that number plates and lamps stand proud of the body
constexpr float kMirrors = 0.25F;  // metres that a mirror sticks out

TEST(MakeVehicle, StaysWithinItsStatedLengthWidthAndHeight) {
  const Materials materials = NamedPlainMaterials();
  for (int kind = 0; kind < kVehicleKinds; ++kind) {
    const VehicleShape& shape = ShapeOf(static_cast<VehicleKind>(kind));
    const Mesh mesh = MakeVehicle(static_cast<VehicleKind>(kind), materials);
    Vector3f low = mesh.positions.front();
    Vector3f high = low;
    for (const Vector3f& p : mesh.positions) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
      const bool at_mirror = p.z() > shape.belt - 0.1F && p.x() > 0;
      EXPECT_LT(std::abs(p.y()), 0.5F * shape.width + (at_mirror ? kMirrors : kPlate)) << kind;
    }
    EXPECT_NEAR(high.x(), 0.5F * shape.length, kPlate) << kind;
    EXPECT_NEAR(low.x(), -0.5F * shape.length, kPlate) << kind;
    EXPECT_NEAR(high.z(), shape.roof, 0.03F) << kind;
    EXPECT_NEAR(low.z(), 0, 1e-3F) << kind;  // the tyres stand on the road
    EXPECT_EQ(VehicleLength(static_cast<VehicleKind>(kind)), shape.length);
    EXPECT_LT(mesh.triangles.size(), 8000U);
  }
}

TEST(MakeVehicle, SkinFacesOutwards) {
  // The paint encloses the car's middle: its area vectors point away from it.
  const Materials materials = NamedPlainMaterials();
  const Mesh mesh = MakeVehicle(VehicleKind::kSaloon, materials);
  const Vector3f middle(0, 0, 0.6F);
  float outward = 0;
  float all = 0;
  for (const Triangle& t : mesh.triangles) {
    if (t.material != materials.paint) continue;
    const Vector3f& a = mesh.positions[t.vertices[0]];
    const Vector3f area =
        (mesh.positions[t.vertices[1]] - a).cross(mesh.positions[t.vertices[2]] - a);
    outward += area.dot(a - middle) > 0 ? area.norm() : 0;
    all += area.norm();
  }
  EXPECT_GT(outward, 0.95F * all);
}

TEST(DrawVehicleKind, DrawsEachKind) {
  Random random(3);
  std::set<VehicleKind> kinds;
  for (int i = 0; i < 200; ++i) kinds.insert(DrawVehicleKind(random));
  EXPECT_EQ(kinds.size(), static_cast<size_t>(kVehicleKinds));
}

}  // namespace
}  // namespace orb360::town
