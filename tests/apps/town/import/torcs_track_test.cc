#include "apps/town/import/torcs_track.h"

#include <gtest/gtest.h>

namespace orb360::town {
namespace {

SourceMesh Road(const std::string& name, std::vector<float> xs) {
  SourceMesh mesh;
  mesh.name = name;
  for (const float x : xs) {
    mesh.positions.emplace_back(x, 1.0F, 4.0F);
    mesh.positions.emplace_back(x, 1.0F, -2.0F);
  }
  return mesh;
}

TEST(FindTorcsCentreline, JoinsThePiecesInTheOrderOfTheirNumbers) {
  SourceScene scene;
  scene.meshes = {Road("TKMN20", {30, 20}), Road("TREE7", {5, 6}), Road("TKMN3", {0, 10, 20}),
                  Road("TKMN100", {30, 40}), Road("TKMN_g", {70})};
  const std::vector<Eigen::Vector3f> line = FindTorcsCentreline(scene);
  ASSERT_EQ(line.size(), 5U);  // ends that pieces share once, the turned piece turned back
  for (size_t i = 0; i < line.size(); ++i)
    EXPECT_TRUE(line[i].isApprox(Eigen::Vector3f(10.0F * static_cast<float>(i), 1, 1)));
}

TEST(FindTorcsCentreline, IsEmptyWithoutARoad) { EXPECT_TRUE(FindTorcsCentreline({}).empty()); }

}  // namespace
}  // namespace orb360::town
