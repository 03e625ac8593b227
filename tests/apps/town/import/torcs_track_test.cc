#include "apps/town/import/torcs_track.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

/// A piece of a round road of radius 100 about (300, 0) in the file's x and z, from one angle to
/// another in degrees, with a pair of vertices every 10 degrees.
SourceMesh Road(const std::string& name, int from, int to) {
  SourceMesh mesh;
  mesh.name = name;
  for (int degrees = from;; degrees += from < to ? 10 : -10) {
    const auto angle = static_cast<float>(degrees * std::numbers::pi / 180);
    for (const float radius : {106.0F, 94.0F})
      mesh.positions.emplace_back(300 + radius * std::cos(angle), 1.0F, radius * std::sin(angle));
    if (degrees == to) return mesh;
  }
}

void ExpectOnceRound(const std::vector<Eigen::Vector3f>& line, bool is_ascending) {
  ASSERT_EQ(line.size(), 36U);  // ends that pieces share once
  for (size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3f radius = line[i] - Eigen::Vector3f(300, 1, 0);
    const Eigen::Vector3f next = line[(i + 1) % line.size()] - Eigen::Vector3f(300, 1, 0);
    EXPECT_NEAR(radius.norm(), 100, 1e-3);
    EXPECT_EQ(radius.y(), 0);
    // Steps of 10 degrees, always the same way round.
    EXPECT_NEAR(radius.x() * next.z() - radius.z() * next.x(),
                (is_ascending ? 1 : -1) * 1e4 * std::sin(std::numbers::pi / 18), 1);
  }
}

TEST(FindTorcsCentreline, JoinsPiecesWhereTheyMeetWhateverTheirNumbersAndDirections) {
  SourceScene scene;
  // By their numbers, 40 and 30 would change places.
  scene.meshes = {Road("TKMN30", 270, 180), Road("TREE7", 0, 90),     Road("TKMN3", 90, 0),
                  Road("TKMN9", 90, 140),   Road("TKMN40", 180, 140), Road("TKMN_g", 0, 90),
                  Road("TKMN100", 270, 360)};
  ExpectOnceRound(FindTorcsCentreline(scene), true);
  scene.meshes = {Road("TKMN1", 0, 90), Road("TKMN2", 360, 200), Road("TKMN3", 90, 200)};
  ExpectOnceRound(FindTorcsCentreline(scene), false);
}

TEST(FindTorcsCentreline, IsEmptyWithoutARingOfRoad) {
  EXPECT_TRUE(FindTorcsCentreline({}).empty());
  SourceScene scene;
  scene.meshes = {Road("TKMN1", 0, 90), Road("TKMN2", 90, 200), Road("TKMN3", 350, 200)};
  EXPECT_TRUE(FindTorcsCentreline(scene).empty());
}

}  // namespace
}  // namespace orb360::town
