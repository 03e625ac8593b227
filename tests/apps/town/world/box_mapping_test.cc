#include "apps/town/world/box_mapping.h"

#include <gtest/gtest.h>

#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

/// A cube of edge length 2 about the origin whose corners are shared.
Surface Cube() {
  Surface cube;
  for (int i = 0; i < 8; ++i)
    cube.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1,
                                (i & 4) != 0 ? 1 : -1);
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    cube.triangles.push_back({a, b, c});
    cube.triangles.push_back({a, c, d});
  };
  quad(0, 2, 3, 1);
  quad(4, 5, 7, 6);
  quad(0, 1, 5, 4);
  quad(2, 6, 7, 3);
  quad(0, 4, 6, 2);
  quad(1, 3, 7, 5);
  return cube;
}

TEST(BoxMapping, NormalsOfACubePointFromItsCorners) {
  const Surface cube = Cube();
  const std::vector<Vector3f> normals = VertexNormals(cube);
  // Corners belong to one or to two triangles of a face, so the mean leans.
  for (size_t i = 0; i < 8; ++i) EXPECT_GT(normals[i].dot(cube.positions[i].normalized()), 0.8F);
}

TEST(BoxMapping, TexturesAreInMetresAndKeepTheirSizeOnEachFace) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  const Surface cube = Cube();
  AddBoxMapped(cube, std::vector<MaterialId>(12, 1), builder);  // a tile of 4 m
  const Mesh& mesh = builder.mesh();
  ASSERT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.positions.size(), 24U);  // each corner once for each of three axes
  for (const Triangle& triangle : mesh.triangles) {
    EXPECT_NEAR(triangle.tiles_per_metre, 0.25F, 1e-6F);
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = triangle.vertices[static_cast<size_t>(k)];
      const uint32_t b = triangle.vertices[static_cast<size_t>((k + 1) % 3)];
      const Vector2f uv(mesh.vertices[b].u - mesh.vertices[a].u,
                        mesh.vertices[b].v - mesh.vertices[a].v);
      EXPECT_NEAR(uv.norm(), 0.25F * (mesh.positions[b] - mesh.positions[a]).norm(), 1e-5F);
    }
  }
}

}  // namespace
}  // namespace orb360::town
