// Shapes of what grows and lies in landscapes.
#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "apps/town/world/landscape/conifer.h"
#include "apps/town/world/landscape/rock.h"
#include "apps/town/world/landscape/undergrowth.h"
#include "apps/town/world/plant_card.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

/// Returns the lowest and the highest vertex of a mesh whose triangle has a material.
std::pair<float, float> HeightsOf(const Mesh& mesh, MaterialId material) {
  float low = 1e9F;
  float high = -1e9F;
  for (const Triangle& triangle : mesh.triangles) {
    if (triangle.material != material) continue;
    for (const uint32_t i : triangle.vertices) {
      low = std::min(low, mesh.positions[i].z());
      high = std::max(high, mesh.positions[i].z());
    }
  }
  return {low, high};
}

TEST(Plants, ConifersAreGreenFromTheirCrownsBaseToTheirTop) {
  const LandscapeMaterials materials = PlainLandscapeMaterials();
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const ConiferShape shape{.height = 12, .crown_base = 5, .spread = 2, .radius = 0.15F};
    const Mesh mesh = MakeConifer(materials, shape, Random(seed));
    const auto [low, high] = HeightsOf(mesh, materials.needles[0]);
    EXPECT_GT(low, shape.crown_base - 1.4F);  // the lowest branches hang
    EXPECT_LT(low, shape.crown_base + 0.5F);
    EXPECT_NEAR(high, shape.height, 1);
    const auto [foot, top] = HeightsOf(mesh, materials.bark);
    EXPECT_LT(foot, 0);  // it stands in the ground, on slopes too
    EXPECT_NEAR(top, shape.height, 0.01F);
  }
}

TEST(Plants, CardsHangAsFarAsTheyDroop) {
  const Materials materials = PlainMaterials();
  MeshBuilder builder(materials);
  AddPlantCard({.along = {1, 0, 0}, .across = {0, 1, 0}, .length = 2, .width = 0.5F, .droop = 0.6F},
               2, builder);
  const Mesh& mesh = builder.mesh();
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const float v = mesh.vertices[i].v;
    EXPECT_NEAR(mesh.positions[i].x(), 2 * v, 1e-6F);
    EXPECT_NEAR(mesh.positions[i].z(), -0.6F * v * v, 1e-6F);
    EXPECT_NEAR(mesh.positions[i].y(), 0.5F * (mesh.vertices[i].u - 0.5F), 1e-6F);
  }
}

TEST(Plants, RocksAreClosedAndAsLargeAsTheyAreMade) {
  const Materials materials = PlainMaterials();
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Mesh rock = MakeRock(materials, 0, 1, Random(seed));
    float reach = 0;
    for (const Vector3f& p : rock.positions) reach = std::max(reach, p.norm());
    EXPECT_GT(reach, 0.6F);
    EXPECT_LT(reach, 1.2F);
    // By the divergence theorem; the areas of a closed surface add up to nothing.
    double volume = 0;
    Vector3f area = Vector3f::Zero();
    for (const Triangle& t : rock.triangles) {
      const Vector3f& p = rock.positions[t.vertices[0]];
      const Vector3f across =
          (rock.positions[t.vertices[1]] - p).cross(rock.positions[t.vertices[2]] - p);
      volume += across.dot(p) / 6;
      area += across;
    }
    EXPECT_GT(volume, 0.2);
    EXPECT_LT(area.norm(), 1e-3F);
  }
}

TEST(Plants, UndergrowthIsAsHighAsStated) {
  const LandscapeMaterials materials = PlainLandscapeMaterials();
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const float fern = HeightsOf(MakeFern(materials, Random(seed)), materials.ferns[0]).second;
    EXPECT_GT(fern, 0.15F);
    EXPECT_LT(fern, 0.95F);
    const float grass =
        HeightsOf(MakeGrass(materials, seed % 2 == 0, Random(seed)), materials.grass_tufts[0])
            .second;
    EXPECT_GT(grass, 0.12F);
    EXPECT_LT(grass, 0.7F);
  }
}

}  // namespace
}  // namespace orb360::town
