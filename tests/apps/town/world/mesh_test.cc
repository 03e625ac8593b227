#include "apps/town/world/mesh.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

const Panel kPanel{{1, 2, 3}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};

TEST(MeshBuilder, RectanglesFaceOutOfThePanel) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  builder.AddRectangle(0, kPanel, 0, 2, 0, 1, 0.5F);
  const Mesh& mesh = builder.mesh();
  ASSERT_EQ(mesh.triangles.size(), 2U);
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3f& a = mesh.positions[triangle.vertices[0]];
    const Vector3f normal =
        (mesh.positions[triangle.vertices[1]] - a).cross(mesh.positions[triangle.vertices[2]] - a);
    EXPECT_GT(normal.normalized().dot(kPanel.out), 0.999F);
    EXPECT_FLOAT_EQ(a.y(), 1.5F);
  }
  for (const Vertex& vertex : mesh.vertices) EXPECT_EQ(vertex.normal.y(), -127);
}

TEST(MeshBuilder, TilesPerMetreFollowTheMaterial) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  builder.AddRectangle(1, kPanel, 0, 3, 0, 1);  // a tile of 4 m
  builder.AddImage(0, kPanel, 0, 2, 0, 2);      // one tile over 2 m
  EXPECT_NEAR(builder.mesh().triangles.front().tiles_per_metre, 0.25F, 1e-5F);
  EXPECT_NEAR(builder.mesh().triangles.back().tiles_per_metre, 0.5F, 1e-5F);
}

TEST(MeshBuilder, BoxesAreClosedButForTheirBack) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  builder.AddBox(0, kPanel, 0, 1, 0, 1, -1, 0);
  // By the divergence theorem the area vectors of a closed surface sum to zero; here the back
  // (area 1, facing against `out`) is missing.
  Vector3f sum = Vector3f::Zero();
  const Mesh& mesh = builder.mesh();
  for (const Triangle& t : mesh.triangles) {
    const Vector3f& a = mesh.positions[t.vertices[0]];
    sum += 0.5F * (mesh.positions[t.vertices[1]] - a).cross(mesh.positions[t.vertices[2]] - a);
  }
  EXPECT_LT((sum - kPanel.out).norm(), 1e-5F);
}

TEST(MeshBuilder, AFaceWithoutAreaLeavesNoVertexWithoutADirection) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  const Vector3f a(0, 0, 0);
  const Vector3f b(1, 0, 0);
  builder.AddFace(0, a, b, b, a);
  builder.AddGroundPolygon(0, {a, b, 2 * b});
  EXPECT_TRUE(builder.mesh().positions.empty());
  EXPECT_TRUE(builder.mesh().triangles.empty());
}

TEST(Mesh, PartitionBringsCutoutsToTheEnd) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  builder.AddRectangle(2, kPanel, 0, 1, 0, 1);
  builder.AddRectangle(0, kPanel, 1, 2, 0, 1);
  builder.AddRectangle(2, kPanel, 2, 3, 0, 1);
  Mesh mesh = builder.mesh();
  mesh.PartitionCutouts(materials);
  EXPECT_EQ(mesh.opaque_count, 2U);
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    EXPECT_EQ(materials[mesh.triangles[i].material].cutout, i >= mesh.opaque_count);
}

}  // namespace
}  // namespace orb360::town
