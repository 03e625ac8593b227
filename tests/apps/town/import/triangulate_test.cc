#include "apps/town/import/triangulate.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace orb360::town {
namespace {

using Corners = std::vector<Eigen::Vector3f>;

/// Sum of the triangles' areas, negative where they turn against `normal`.
double Area(const Corners& corners, const Eigen::Vector3f& normal) {
  double sum = 0;
  for (const auto& [a, b, c] : Triangulate(corners)) {
    const double area = 0.5 * normal.dot((corners[b] - corners[a]).cross(corners[c] - corners[a]));
    EXPECT_GE(area, -1e-6);
    sum += area;
  }
  return sum;
}

TEST(Triangulate, AConvexPolygonIsAFanAroundItsFirstCorner) {
  const Corners square = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
  const auto triangles = Triangulate(square);
  ASSERT_EQ(triangles.size(), 2U);
  EXPECT_EQ(triangles[0], (std::array<size_t, 3>{0, 1, 2}));
  EXPECT_EQ(triangles[1], (std::array<size_t, 3>{0, 2, 3}));
}

TEST(Triangulate, AConcavePolygonIsFilledAndNothingElse) {
  // A fan around the first corner would cover 2 square metres outside of this L.
  const Corners outline = {{2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {2, 0, 0}};
  EXPECT_NEAR(Area(outline, Eigen::Vector3f::UnitZ()), 3, 1e-6);
  EXPECT_EQ(Triangulate(outline).size(), 4U);
  const Corners arrow = {{0, 0, 0}, {4, -3, 0}, {1, 0, 0}, {4, 3, 0}};
  EXPECT_NEAR(Area(arrow, Eigen::Vector3f::UnitZ()), 3, 1e-6);
  const Corners from_its_notch = {{1, 0, 0}, {4, 3, 0}, {0, 0, 0}, {4, -3, 0}};
  EXPECT_NEAR(Area(from_its_notch, Eigen::Vector3f::UnitZ()), 3, 1e-6);
}

TEST(Triangulate, APolygonMayStandInAnyPlaneAndTurnEitherWay) {
  const Eigen::AngleAxisf turn(1.1F, Eigen::Vector3f(1, -2, 3).normalized());
  Corners star;
  double area = 0;
  constexpr int kPoints = 20;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * M_PI * i / kPoints;
    const double radius = i % 2 == 0 ? 3 : 1;
    star.emplace_back(
        turn *
        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 7).cast<float>());
    area += 0.5 * 3 * 1 * std::sin(2 * M_PI / kPoints);
  }
  const Eigen::Vector3f normal = turn * Eigen::Vector3f::UnitZ();
  EXPECT_NEAR(Area(star, normal), area, 1e-4);
  const Corners backwards(star.rbegin(), star.rend());
  EXPECT_NEAR(Area(backwards, -normal), area, 1e-4);
}

TEST(Triangulate, DegeneratePolygonsAreTakenAsTheyAre) {
  EXPECT_TRUE(Triangulate(Corners{{0, 0, 0}, {1, 0, 0}}).empty());
  const Corners line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  EXPECT_LE(Triangulate(line).size(), 2U);
  const Corners crossing = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}, {1, 3, 0}};
  EXPECT_EQ(Triangulate(crossing).size(), 3U);
}

}  // namespace
}  // namespace orb360::town
