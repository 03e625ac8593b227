#include "apps/town/world/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "apps/town/world/road_details.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

/// Height of the triangle over a place of the plan, or nothing where it does not reach.
std::optional<double> HeightAt(const Mesh& mesh, const Triangle& triangle, const Vector2d& place) {
  std::array<Eigen::Vector3d, 3> p;
  for (size_t i = 0; i < 3; ++i) p[i] = mesh.positions[triangle.vertices[i]].cast<double>();
  Eigen::Matrix2d edges;
  edges << (p[1] - p[0]).head<2>(), (p[2] - p[0]).head<2>();
  if (std::abs(edges.determinant()) < 1e-9) return std::nullopt;
  const Vector2d fraction = edges.inverse() * (place - p[0].head<2>());
  if (fraction.minCoeff() < 0 || fraction.sum() > 1) return std::nullopt;
  return p[0].z() + fraction[0] * (p[1].z() - p[0].z()) + fraction[1] * (p[2].z() - p[0].z());
}

/// The triangles of a mesh by the cells of 2 m that they reach.
class Surface {
 public:
  explicit Surface(const Mesh& mesh) : mesh_(&mesh) {
    for (const Triangle& triangle : mesh.triangles) {
      Eigen::AlignedBox2d box;
      for (const uint32_t v : triangle.vertices)
        box.extend(mesh.positions[v].head<2>().cast<double>());
      for (int x = Cell(box.min().x()); x <= Cell(box.max().x()); ++x)
        for (int y = Cell(box.min().y()); y <= Cell(box.max().y()); ++y)
          cells_[{x, y}].push_back(&triangle);
    }
  }

  /// The highest triangle there.
  std::optional<double> HeightAt(const Vector2d& place) const {
    std::optional<double> highest;
    const auto cell = cells_.find({Cell(place.x()), Cell(place.y())});
    if (cell == cells_.end()) return highest;
    for (const Triangle* triangle : cell->second) {
      const std::optional<double> height = town::HeightAt(*mesh_, *triangle, place);
      if (height && (!highest || *height > *highest)) highest = height;
    }
    return highest;
  }

 private:
  static int Cell(double x) { return static_cast<int>(std::floor(x / 2.0)); }

  const Mesh* mesh_;
  std::map<std::pair<int, int>, std::vector<const Triangle*>> cells_;
};

/// How far places of `upper`, seven in each triangle, are above `lower`, metres, where there is any
/// lower.
std::vector<double> GapsBetween(const Mesh& upper, const Mesh& lower) {
  const Surface surface(lower);
  std::vector<double> gaps;
  for (const Triangle& triangle : upper.triangles) {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i)
      corners.col(i) = upper.positions[triangle.vertices[static_cast<size_t>(i)]].cast<double>();
    for (const Eigen::Vector3d& fraction :
         {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(4, 1, 1), Eigen::Vector3d(1, 4, 1),
          Eigen::Vector3d(1, 1, 4), Eigen::Vector3d(1, 9, 9), Eigen::Vector3d(9, 1, 9),
          Eigen::Vector3d(9, 9, 1)}) {
      const Eigen::Vector3d place = corners * (fraction / fraction.sum());
      const std::optional<double> below = surface.HeightAt(place.head<2>());
      if (below) gaps.push_back(place.z() - *below);
    }
  }
  return gaps;
}

struct Road {
  explicit Road(uint64_t seed) : ground(materials), details(materials), markings(materials) {
    PlanOptions options;
    options.seed = seed;
    const StreetPlan plan = PlanStreets(options);
    AddGround(plan, ground);
    AddRoadDetails(plan, Random(seed), details);
    AddRoadMarkings(plan, markings);
  }

  Materials materials = NamedPlainMaterials();
  MeshBuilder ground;
  MeshBuilder details;
  MeshBuilder markings;
};

// What is mapped of a road is mostly the corners of its markings, and the camera's height over them
// is the measure of everything.
TEST(AddRoadMarkings, AreNowhereHiddenAndNoThickerThanPaintOnRoads) {
  for (const uint64_t seed : {4, 5}) {
    Road road(seed);
    const std::vector<double> over_asphalt = GapsBetween(road.markings.mesh(), road.ground.mesh());
    ASSERT_GT(over_asphalt.size(), 10'000U);
    const auto [least, most] = std::ranges::minmax(over_asphalt);
    EXPECT_GT(least, 0.0012);
    EXPECT_LT(most, 0.003);
    const std::vector<double> over_details = GapsBetween(road.markings.mesh(), road.details.mesh());
    ASSERT_GT(over_details.size(), 10U);
    EXPECT_GT(std::ranges::min(over_details), 0.0001);
  }
}

TEST(AddRoadDetails, AreNowhereHiddenByTheAsphalt) {
  for (const uint64_t seed : {4, 5}) {
    Road road(seed);
    const std::vector<double> gaps = GapsBetween(road.details.mesh(), road.ground.mesh());
    ASSERT_GT(gaps.size(), 1'000U);
    EXPECT_GT(std::ranges::min(gaps), 0.0002);
  }
}

}  // namespace
}  // namespace orb360::town
