#include "apps/town/render/irradiance.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "apps/town/world/tessellate.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

constexpr float kHeight = 2.5F;  // metres of the lamp above the floor
constexpr float kSide = 0.4F;    // metres, of the lamp

Light Darkness() {
  Light light;
  light.name = "none";
  return light;
}

/// A floor of 8 m x 8 m around the origin, with a lamp above it that shines downwards.
Scenery FloorUnderLamp(bool has_shade) {
  const Materials materials = NamedPlainMaterials();
  MeshBuilder builder(materials);
  const Panel floor{{-4, -4, 0}, Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()};
  builder.AddRectangle(0, floor, 0, 8, 0, 8);
  if (has_shade) builder.AddRectangle(0, floor, 3, 5, 3, 5, 1.5F);
  Scenery scenery;
  scenery.fixed = std::move(builder.mesh());
  Tessellate(0.5F, &scenery.fixed);
  scenery.fixed.PartitionCutouts(materials);
  scenery.palette = materials;
  scenery.lamps.push_back(
      {{-0.5F * kSide, -0.5F * kSide, kHeight}, {0, kSide, 0}, {kSide, 0, 0}, {3, 2, 1}, false});
  return scenery;
}

/// The light of the lamp at (x, y) on the floor, over pi: an integral over a fine lattice.
double LampLight(double x, double y) {
  constexpr int kCells = 200;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int k = 0; k < kCells; ++k) {
      const double dx = kSide * ((i + 0.5) / kCells - 0.5) - x;
      const double dy = kSide * ((k + 0.5) / kCells - 0.5) - y;
      const double squared = dx * dx + dy * dy + kHeight * kHeight;
      sum += kHeight * kHeight / (squared * squared);
    }
  }
  return sum * kSide * kSide / (kCells * kCells) / std::numbers::pi;
}

TEST(Irradiance, OfALampOverAFloorAgreesWithTheIntegral) {
  Scenery scenery = FloorUnderLamp(false);
  BakeIrradiance(RayScene(scenery), Darkness(), &scenery);
  const Mesh& mesh = scenery.fixed;
  ASSERT_EQ(mesh.irradiance.size(), mesh.vertices.size());
  int compared = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    if (p.head<2>().norm() > 3) continue;  // places at the edge lie a little inside
    const double expected = LampLight(p.x(), p.y());
    EXPECT_NEAR(mesh.irradiance[i].x(), 3 * expected, 0.04 * 3 * expected) << p.transpose();
    EXPECT_NEAR(mesh.irradiance[i].z(), expected, 0.04 * expected) << p.transpose();
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(Irradiance, IsSmallInTheShadowOfAShade) {
  Scenery scenery = FloorUnderLamp(true);
  BakeIrradiance(RayScene(scenery), Darkness(), &scenery);
  const Mesh& mesh = scenery.fixed;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    if (p.z() == 0 && p.head<2>().norm() < 1) {
      EXPECT_LT(mesh.irradiance[i].maxCoeff(), 1e-3F) << p.transpose();
    }
    if (p.z() == 0 && p.x() > 3.2F) {
      EXPECT_GT(mesh.irradiance[i].x(), 0.5 * 3 * LampLight(p.x(), p.y())) << p.transpose();
    }
  }
}

TEST(Irradiance, OfAWhiteWallIsThrownBackToTheFloor) {
  // The floor next to a wall sees half of its hemisphere filled by it, so it gets about half of
  // the wall's radiance in addition.
  const Materials materials = NamedPlainMaterials();
  MeshBuilder builder(materials);
  const Panel wall{{0, 10, 0}, -Vector3f::UnitY(), Vector3f::UnitZ(), Vector3f::UnitX()};
  builder.AddRectangle(0, wall, 0, 20, 0, 10);
  const Panel floor{{0.05F, -1, 0}, Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()};
  builder.AddRectangle(0, floor, 0, 0.2F, 0, 2);
  Scenery scenery;
  scenery.fixed = std::move(builder.mesh());
  Tessellate(0.5F, &scenery.fixed);
  scenery.fixed.PartitionCutouts(materials);
  scenery.palette = materials;
  // A huge window opposite the wall, beyond which everything is equally bright.
  scenery.lamps.push_back({{30, -40, -40}, {0, 0, 80}, {0, 80, 0}, {1, 1, 1}, false});
  Light light = Darkness();
  BakeIrradiance(RayScene(scenery), light, &scenery);
  float on_wall = 0;
  float on_floor = 0;
  const Mesh& mesh = scenery.fixed;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    if (p.x() == 0 && std::abs(p.y()) < 0.7F && p.z() < 3) on_wall = mesh.irradiance[i].x();
    if (p.z() == 0 && p.x() > 0 && std::abs(p.y()) < 0.3F) on_floor = mesh.irradiance[i].x();
  }
  scenery.palette.textures[0] = Texture::Paint(16, [](float, float) { return Rgba{0, 0, 0, 1}; });
  BakeIrradiance(RayScene(scenery), light, &scenery);
  float direct = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    if (p.z() == 0 && p.x() > 0 && std::abs(p.y()) < 0.3F) direct = mesh.irradiance[i].x();
  }
  constexpr float kAlbedo = 0.5F;
  EXPECT_NEAR(on_floor - direct, 0.5F * kAlbedo * on_wall, 0.1F * 0.5F * kAlbedo * on_wall);
}

}  // namespace
}  // namespace orb360::town
