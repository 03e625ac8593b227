#include "apps/town/world/roof.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

/// The greatest height at which a plumb line through (x, y) meets the mesh; very low if nowhere.
float HighestAt(const Mesh& mesh, float x, float y) {
  float highest = -1e30F;
  for (const Triangle& t : mesh.triangles) {
    const Vector3f& a = mesh.positions[t.vertices[0]];
    const Vector3f ab = mesh.positions[t.vertices[1]] - a;
    const Vector3f ac = mesh.positions[t.vertices[2]] - a;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (std::abs(area) < 1e-7F) continue;
    const float u = ((x - a.x()) * ac.y() - (y - a.y()) * ac.x()) / area;
    const float v = (ab.x() * (y - a.y()) - ab.y() * (x - a.x())) / area;
    if (u < -1e-5F || v < -1e-5F || u + v > 1 + 1e-5F) continue;
    highest = std::max(highest, a.z() + u * ab.z() + v * ac.z());
  }
  return highest;
}

TEST(AddRoof, NoRayFromAboveReachesTheAttic) {
  const Materials materials = NamedPlainMaterials();
  for (const RoofKind kind :
       {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip, RoofKind::kMansard}) {
    for (uint64_t seed = 0; seed < 8; ++seed) {
      Random random(seed);
      Lot lot;
      lot.front_left = {3, -2, 0.5F};
      lot.right = {1, 0, 0};
      lot.width = static_cast<float>(random.Uniform(6, 20));
      lot.depth = static_cast<float>(random.Uniform(9, 14));
      FacadeStyle style;
      style.roof = kind;
      MeshBuilder builder(materials);
      AddRoof(builder, style, lot, random);
      const float eaves = lot.front_left.z() + EavesHeight(style);
      constexpr int kSteps = 37;
      for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; j <= kSteps; ++j) {
          const float x = lot.front_left.x() + lot.width * (0.001F + 0.998F * i / kSteps);
          const float y = lot.front_left.y() + lot.depth * (0.001F + 0.998F * j / kSteps);
          ASSERT_GT(HighestAt(builder.mesh(), x, y), eaves)
              << "kind " << static_cast<int>(kind) << " seed " << seed << " at " << x << ' ' << y;
        }
      }
      EXPECT_LT(builder.mesh().triangles.size(), 3000U);
    }
  }
}

}  // namespace
}  // namespace orb360::town
