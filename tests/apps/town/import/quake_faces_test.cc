#include "apps/town/import/quake_faces.h"

#include <algorithm>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "apps/town/import/quake_light.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using Eigen::Vector3f;

QuakeVertex At(const Vector3f& position, const Eigen::Vector2f& light_uv) {
  return {position, {0, 0}, light_uv, Vector3f::UnitZ(), Vector3f::Zero()};
}

/// A channel along y whose floor is z = h * (1 - (x / w)^2) ... two patches of 3 x 3, side by side
/// in y.
QuakeMap Arch(float width, float height) {
  QuakeMap map;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 3; ++x) {
      // The middle control point is twice as high as the curve.
      map.vertices.push_back(At(
          {width * static_cast<float>(x - 1), 40 * static_cast<float>(y), x == 1 ? 2 * height : 0},
          {static_cast<float>(x) / 2, static_cast<float>(y) / 4}));
    }
  }
  QuakeFace face;
  face.kind = QuakeFaceKind::kPatch;
  face.vertex_count = 15;
  face.patch_width = 3;
  face.patch_height = 5;
  map.faces = {face};
  return map;
}

TEST(QuakeFaces, APatchIsAParabola) {
  constexpr float kWidth = 100;
  constexpr float kHeight = 60;
  const QuakeMap map = Arch(kWidth, kHeight);
  const FaceMesh mesh = TrianglesOf(map, map.faces[0]);
  const auto height_at = [](float x) { return kHeight * (1 - x * x / (kWidth * kWidth)); };
  for (const QuakeVertex& vertex : mesh.vertices) {
    const Vector3f& p = vertex.position;
    EXPECT_NEAR(p.z(), height_at(p.x()), 1e-3);
    EXPECT_NEAR(vertex.light_uv.x(), 0.5F + 0.5F * p.x() / kWidth, 1e-5);
    EXPECT_NEAR(vertex.light_uv.y(), p.y() / 160, 1e-5);
  }
  double floor_plan = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto p = [&](uint32_t i) -> const Vector3f& { return mesh.vertices[i].position; };
    floor_plan += (p(b) - p(a)).cross(p(c) - p(a)).z() / 2;  // all face upward
    const Vector3f centre = (p(a) + p(b) + p(c)) / 3;
    EXPECT_NEAR(centre.z(), height_at(centre.x()), 0.25);
  }
  EXPECT_NEAR(floor_plan, 2 * kWidth * 160, 1);
  // Not finer than needed: a second difference of 240 asks for sqrt(240 / (4 / 4)) segments.
  EXPECT_LE(mesh.triangles.size(), 2U * 16 * 2);
}

TEST(QuakeFaces, DivisionIsConformingAndEndsAtOnePixelOfLight) {
  QuakeMap map;
  for (const auto& [x, y] :
       {std::pair(0.F, 0.F), std::pair(300.F, 0.F), std::pair(300.F, 7.F), std::pair(20.F, 170.F)})
    map.vertices.push_back(At({x, y, 0}, {x / 3000, y / 3000}));
  map.indices = {0, 1, 2, 0, 2, 3};
  QuakeFace face;
  face.vertex_count = 4;
  face.index_count = 6;
  FaceMesh mesh = TrianglesOf(map, face);
  DivideForLight(12, 100000, &mesh);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const auto p = [&](size_t k) -> const Vector3f& { return mesh.vertices[t[k]].position; };
    area += (p(1) - p(0)).cross(p(2) - p(0)).z() / 2;
    for (size_t k = 0; k < 3; ++k) {
      ++edges[std::minmax(t[k], t[(k + 1) % 3])];
      // A pixel is 3000 / 128 = 23 units wide.
      EXPECT_LE((p(k) - p((k + 1) % 3)).norm(), 3000.0 / 128 + 1e-3);
    }
  }
  EXPECT_NEAR(area, 0.5 * (300 * 7 + std::abs(300 * 170 - 20 * 7)), 1);
  for (const auto& [edge, count] : edges) {
    if (count == 2) continue;
    // An edge of one triangle only lies on the border of the face.
    ASSERT_EQ(count, 1);
    const Vector3f middle =
        0.5F * (mesh.vertices[edge.first].position + mesh.vertices[edge.second].position);
    double nearest = 1e9;
    for (size_t k = 0; k < 4; ++k) {
      const Vector3f a = map.vertices[k].position;
      const Vector3f b = map.vertices[(k + 1) % 4].position;
      nearest = std::min<double>(nearest, (middle - a).cross((b - a).normalized()).norm());
    }
    EXPECT_LT(nearest, 1e-3);
  }
  FaceMesh limited = TrianglesOf(map, face);
  EXPECT_THROW(DivideForLight(12, 20, &limited), UserError);
}

TEST(QuakeLight, IsDoubledTwiceAndKeepsItsHue) {
  EXPECT_NEAR(QuakeIrradiance({63.75F, 0, 0}).x(), 1, 1e-5);
  const Vector3f bright = QuakeIrradiance({255, 127.5F, 0});
  EXPECT_NEAR(bright.x(), std::pow(2, 2.2), 1e-3);
  EXPECT_NEAR(bright.y(), 1, 1e-3);
  EXPECT_EQ(bright.z(), 0);
}

}  // namespace
}  // namespace orb360::town
