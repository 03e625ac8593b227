#include "slam/io/mesh_file.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kCellSize = 0.1;
// Its centre is the corner of eight cubes of cells.
constexpr double kRadius = 4.0;

std::vector<SurfacePoint> Sphere() {
  std::vector<SurfacePoint> points;
  const int count = static_cast<int>(4 * std::numbers::pi * std::pow(kRadius / kCellSize, 2));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double longitude = 2 * std::numbers::pi * i / std::numbers::phi;
    const double radius = std::sqrt(1 - z * z);
    const Eigen::Vector3f normal =
        Eigen::Vector3d(radius * std::cos(longitude), radius * std::sin(longitude), z)
            .cast<float>();
    points.push_back({static_cast<float>(kRadius) * normal, normal, {10, 20, 30}, 0.8F});
  }
  return points;
}

template <typename T>
T Read(const char** bytes) {
  T value;
  std::memcpy(&value, *bytes, sizeof value);
  *bytes += sizeof value;
  return value;
}

TEST(MeshWriter, WritesAClosedSurfaceAcrossCubes) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "mesh.ply";
  MeshSummary summary;
  {
    MeshWriter writer(path, kCellSize, {}, 2);
    const std::vector<SurfacePoint> points = Sphere();
    writer.Add(std::span(points).first(1000));
    writer.Add(std::span(points).subspan(1000));
    EXPECT_TRUE(std::filesystem::exists(folder / "mesh.ply.points"));
    summary = writer.Write();
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "mesh.ply.points"));
  ASSERT_GT(summary.vertices, 10000u);

  const std::string text = ReadText(path);
  const size_t end = text.find("end_header\n") + 11;
  const std::string header = text.substr(0, end);
  EXPECT_NE(header.find("element vertex " + std::to_string(summary.vertices)), std::string::npos);
  EXPECT_NE(header.find("element face " + std::to_string(summary.triangles)), std::string::npos);
  ASSERT_EQ(text.size(), end + 27 * summary.vertices + 13 * summary.triangles);
  const char* bytes = text.data() + end;
  for (size_t i = 0; i < summary.vertices; ++i) {
    Eigen::Vector3f position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = Read<float>(&bytes);
    EXPECT_NEAR(position.norm(), kRadius, 0.2 * kCellSize);
    bytes += 12;  // The normal.
    EXPECT_EQ(Read<std::uint8_t>(&bytes), 10);
    bytes += 2;
  }
  std::map<std::pair<int, int>, int> edges;
  for (size_t i = 0; i < summary.triangles; ++i) {
    ASSERT_EQ(Read<std::uint8_t>(&bytes), 3);
    std::array<int, 3> corners{};
    for (int& corner : corners) corner = Read<std::int32_t>(&bytes);
    for (int c = 0; c < 3; ++c) {
      ASSERT_LT(corners[c], static_cast<int>(summary.vertices));
      ++edges[{corners[c], corners[(c + 1) % 3]}];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(static_cast<std::int64_t>(summary.vertices) -
                static_cast<std::int64_t>(edges.size() / 2) +
                static_cast<std::int64_t>(summary.triangles),
            2);
}

TEST(MeshWriter, OfNoPointsIsAnEmptyMesh) {
  const TempFolder folder;
  const MeshSummary summary = MeshWriter(folder / "mesh.ply", kCellSize, {}, 1).Write();
  EXPECT_EQ(summary.vertices, 0u);
  EXPECT_TRUE(ReadText(folder / "mesh.ply").ends_with("end_header\n"));
}

TEST(MeshWriter, AFolderThatCannotBeWrittenIsAnError) {
  const TempFolder folder;
  EXPECT_THROW(MeshWriter(folder / "mesh.ply", -1, {}, 1), ContractError);
  WriteText(folder / "file", "");
  EXPECT_THROW(MeshWriter(folder / "file" / "mesh.ply", kCellSize, {}, 1), UserError);
}

}  // namespace
}  // namespace orb360
