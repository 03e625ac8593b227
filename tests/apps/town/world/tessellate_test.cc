#include "apps/town/world/tessellate.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

float AreaOf(const Mesh& mesh) {
  float area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3f& a = mesh.positions[t.vertices[0]];
    area +=
        0.5F * (mesh.positions[t.vertices[1]] - a).cross(mesh.positions[t.vertices[2]] - a).norm();
  }
  return area;
}

TEST(Tessellate, LeavesNoLongEdgeAndNoGap) {
  const Materials materials = NamedPlainMaterials();
  MeshBuilder builder(materials);
  const Panel floor{{0, 0, 0}, Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()};
  builder.AddRectangle(0, floor, 0, 5, 0, 3.3F);
  Mesh mesh = std::move(builder.mesh());
  const float area = AreaOf(mesh);
  Tessellate(0.4F, &mesh);
  EXPECT_NEAR(AreaOf(mesh), area, 1e-3F);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = t.vertices[i];
      const uint32_t b = t.vertices[(i + 1) % 3];
      EXPECT_LE((mesh.positions[a] - mesh.positions[b]).norm(), 0.4F);
      ++edges[std::minmax(a, b)];
    }
    const Vector3f ab = mesh.positions[t.vertices[1]] - mesh.positions[t.vertices[0]];
    const Vector3f ac = mesh.positions[t.vertices[2]] - mesh.positions[t.vertices[0]];
    EXPECT_GT(ab.cross(ac).z(), 0);
  }
  // An edge of one triangle only lies on the rim.
  for (const auto& [edge, count] : edges) {
    const Vector3f middle = 0.5F * (mesh.positions[edge.first] + mesh.positions[edge.second]);
    const float inside =
        std::min(std::min(middle.x(), 5 - middle.x()), std::min(middle.y(), 3.3F - middle.y()));
    EXPECT_EQ(count, inside > 1e-4F ? 2 : 1) << middle.transpose();
  }
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.vertices[i].u, mesh.positions[i].x(), 1e-4F);
    EXPECT_NEAR(mesh.vertices[i].v, mesh.positions[i].y(), 1e-4F);
  }
}

}  // namespace
}  // namespace orb360::town
