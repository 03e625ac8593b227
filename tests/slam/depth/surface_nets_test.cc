#include "slam/depth/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

const Eigen::Vector3d kCentre(31.3, 32.6, 30.9);  // In cells.
constexpr double kRadius = 20;
constexpr double kCellSize = 0.05;

// Points on a sphere, about one in each cell that it crosses, in the unit of kCellSize.
std::vector<SurfacePoint> Sphere() {
  std::vector<SurfacePoint> points;
  const int count = static_cast<int>(4 * std::numbers::pi * kRadius * kRadius);
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double longitude = 2 * std::numbers::pi * i / std::numbers::phi;
    const double radius = std::sqrt(1 - z * z);
    const Eigen::Vector3d normal(radius * std::cos(longitude), radius * std::sin(longitude), z);
    points.push_back({(kCellSize * (kCentre + kRadius * normal)).cast<float>(),
                      normal.cast<float>(),
                      {200, 100, 50},
                      0.8F});
  }
  return points;
}

SurfacePart Extract(const std::vector<SurfacePoint>& points, const SurfaceNetsOptions& options = {},
                    int num_threads = 1) {
  return ExtractSurface(points, {0, 0, 0}, 64, kCellSize, options, num_threads);
}

// The number of triangles at each edge, by direction.
std::map<std::pair<CellIndex, CellIndex>, int> CountEdges(const SurfacePart& part) {
  std::map<std::pair<CellIndex, CellIndex>, int> edges;
  for (const auto& triangle : part.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  return edges;
}

TEST(ExtractSurface, LiesOnASphereAndLooksOutward) {
  const SurfacePart part = Extract(Sphere());
  ASSERT_GT(part.vertices.size(), 4000u);
  ASSERT_EQ(part.cells.size(), part.vertices.size());
  std::map<CellIndex, Eigen::Vector3d> positions;
  for (size_t i = 0; i < part.vertices.size(); ++i) {
    const Eigen::Vector3d position = part.vertices[i].position.cast<double>() / kCellSize;
    const Eigen::Vector3d outward = position - kCentre;
    // Tangent planes pass outside a sphere; the vertex of a cell is a mean and lies inside.
    EXPECT_NEAR(outward.norm(), kRadius, 0.15);
    EXPECT_GT(part.vertices[i].normal.dot(outward.normalized().cast<float>()), 0.99F);
    EXPECT_EQ(part.vertices[i].rgb, (std::array<std::uint8_t, 3>{200, 100, 50}));
    positions[part.cells[i]] = position;
  }
  for (const auto& triangle : part.triangles) {
    const Eigen::Vector3d& a = positions.at(triangle[0]);
    const Eigen::Vector3d& b = positions.at(triangle[1]);
    const Eigen::Vector3d& c = positions.at(triangle[2]);
    EXPECT_GE((b - a).cross(c - a).dot(a - kCentre), -1e-6);
  }
}

TEST(ExtractSurface, IsClosedWhereTheCloudIsClosed) {
  const SurfacePart part = Extract(Sphere());
  const auto edges = CountEdges(part);
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  // Euler's formula: vertices - edges + faces = 2.
  EXPECT_EQ(static_cast<int>(part.vertices.size()) - static_cast<int>(edges.size()) / 2 +
                static_cast<int>(part.triangles.size()),
            2);
}

TEST(ExtractSurface, AHoleInTheCloudRemainsAHole) {
  std::vector<SurfacePoint> points = Sphere();
  std::erase_if(points, [](const SurfacePoint& point) {
    return point.position.x() / kCellSize > kCentre.x() + 10;
  });
  double farthest = 0;
  for (const SurfacePoint& vertex : Extract(points).vertices) {
    farthest = std::max(farthest, vertex.position.x() / kCellSize);
  }
  EXPECT_GT(farthest, kCentre.x() + 9);
  EXPECT_LT(farthest, kCentre.x() + 12);
}

TEST(ExtractSurface, FewPointsMakeNoSurface) {
  std::vector<SurfacePoint> points = Sphere();
  points.resize(5);
  EXPECT_TRUE(Extract(points).vertices.empty());
  EXPECT_TRUE(Extract({}).vertices.empty());
}

TEST(ExtractSurface, UncertainPointsCountLittle) {
  // A plane that is certain, and one half a cell above it that is not.
  std::vector<SurfacePoint> points;
  for (int x = 0; x < 60; ++x) {
    for (int y = 0; y < 60; ++y) {
      const auto at = [&](double z) {
        return (kCellSize * Eigen::Vector3d(x + 0.5, y + 0.5, z)).cast<float>().eval();
      };
      points.push_back({at(20.3), Eigen::Vector3f::UnitZ(), {}, 0.9F});
      points.push_back({at(20.8), Eigen::Vector3f::UnitZ(), {}, 0.4F});
    }
  }
  const SurfacePart part = Extract(points);
  ASSERT_GT(part.vertices.size(), 3000u);
  for (const SurfacePoint& vertex : part.vertices) {
    EXPECT_NEAR(vertex.position.z() / kCellSize, 20.3, 0.02);
  }
}

TEST(ExtractSurface, PartsOfNeighbouringCubesAreThatOfOneCube) {
  const std::vector<SurfacePoint> points = Sphere();
  const SurfacePart whole = Extract(points);
  std::map<CellIndex, Eigen::Vector3f> vertices;
  std::set<std::array<CellIndex, 3>> triangles;
  const int margin = SurfaceMargin({});
  for (int i = 0; i < 8; ++i) {
    const CellIndex first{32 * (i & 1), 32 * (i >> 1 & 1), 32 * (i >> 2)};
    std::vector<SurfacePoint> near;
    std::ranges::copy_if(points, std::back_inserter(near), [&](const SurfacePoint& point) {
      for (int axis = 0; axis < 3; ++axis) {
        const double cell = std::floor(point.position[axis] / kCellSize) - first[axis];
        if (cell < -margin || cell >= 32 + margin) return false;
      }
      return true;
    });
    const SurfacePart part = ExtractSurface(near, first, 32, kCellSize, {}, 1);
    for (size_t v = 0; v < part.vertices.size(); ++v) {
      EXPECT_TRUE(vertices.emplace(part.cells[v], part.vertices[v].position).second);
    }
    for (const auto& triangle : part.triangles) EXPECT_TRUE(triangles.insert(triangle).second);
  }
  ASSERT_EQ(vertices.size(), whole.vertices.size());
  for (size_t v = 0; v < whole.vertices.size(); ++v) {
    EXPECT_EQ(vertices.at(whole.cells[v]), whole.vertices[v].position);
  }
  EXPECT_EQ(triangles, std::set(whole.triangles.begin(), whole.triangles.end()));
}

TEST(ExtractSurface, IsTheSameForAnyNumberOfThreads) {
  const SurfacePart one = Extract(Sphere(), {}, 1);
  const SurfacePart three = Extract(Sphere(), {}, 3);
  EXPECT_EQ(one.cells, three.cells);
  EXPECT_EQ(one.triangles, three.triangles);
}

TEST(ExtractSurface, ContractsAreChecked) {
  EXPECT_THROW(ExtractSurface({}, {0, 0, 0}, 40, 1.0, {}, 1), ContractError);
  EXPECT_THROW(ExtractSurface({}, {0, 0, 0}, 32, 0.0, {}, 1), ContractError);
  EXPECT_THROW(ExtractSurface({{{{500, 0, 0}, {1, 0, 0}, {}, 1}}}, {0, 0, 0}, 32, 1.0, {}, 1),
               ContractError);
}

}  // namespace
}  // namespace orb360
