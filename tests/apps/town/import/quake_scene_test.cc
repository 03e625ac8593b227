#include "apps/town/import/quake_scene.h"

#include <cmath>
#include <fstream>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "apps/town/image/random.h"
#include "apps/town/import/import_scenery.h"
#include "apps/town/import/quake_bsp.h"
#include "apps/town/import/quake_light.h"
#include "tests/apps/town/import/quake_bsp_builder.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using Eigen::Vector3f;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class QuakeSceneTest : public testing::Test {
 protected:
  QuakeSceneTest()
      : game_(std::filesystem::temp_directory_path() / ("quake_test_" + std::to_string(getpid()))) {
    for (const char* folder : {"maps", "scripts", "textures/base"})
      std::filesystem::create_directories(game_ / folder);
  }
  ~QuakeSceneTest() override { std::filesystem::remove_all(game_); }

  std::filesystem::path Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(game_ / name, std::ios::binary) << bytes;
    return game_ / name;
  }
  std::string Problem(const std::string& bytes) const {
    try {
      ReadQuakeScene(Write("maps/bad.bsp", bytes));
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path game_;
};

/// A floor of 64 x 64 units that faces upward.
constexpr float kSide = 64;
std::array<Vector3f, 4> Floor(float z) {
  return {Vector3f(0, 0, z), Vector3f(0, kSide, z), Vector3f(kSide, kSide, z),
          Vector3f(kSide, 0, z)};
}

/// One page whose red grows by one a pixel in u, and green in v.
std::string GradientPage() {
  std::string page;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      page += static_cast<char>(x);
      page += static_cast<char>(y);
      page += '\x10';
    }
  }
  return page;
}

QuakeBspBuilder SmallMap() {
  QuakeBspBuilder map;
  map.entities =
      "{\n\"classname\" \"worldspawn\"\n}\n{\n\"classname\" \"info_player_deathmatch\"\n"
      "\"origin\" \"32 16 24\"\n}\n{\n\"classname\" \"func_static\"\n\"model\" \"*1\"\n"
      "\"origin\" \"0 0 100\"\n}\n{\n\"classname\" \"func_door\"\n\"model\" \"*2\"\n}\n";
  map.light_pages = GradientPage();
  const int stone = map.AddShader("textures/base/Stone");
  const int sky = map.AddShader("textures/base/sky", QuakeBits::kSky);
  map.AddQuad(stone, Floor(0), Vector3f::UnitZ(), 0);
  map.AddQuad(sky, Floor(50), -Vector3f::UnitZ(), -1);
  map.EndModel();
  map.AddQuad(stone, Floor(0), Vector3f::UnitZ(), -3);
  map.EndModel();
  map.AddQuad(stone, Floor(7), Vector3f::UnitZ(), -3);
  map.EndModel();
  return map;
}

TEST_F(QuakeSceneTest, FacesCarryTheirTextureAndTheirLight) {
  cv::imwrite((game_ / "textures/base/stone.jpg").string(), cv::Mat3b(4, 4, cv::Vec3b(9, 9, 9)));
  const SourceScene scene = ReadQuakeScene(Write("maps/small.bsp", SmallMap().Bytes()));
  ASSERT_EQ(scene.meshes.size(), 1U);  // without the sky, and the door with the same surface
  const SourceMesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.name, "textures/base/Stone");
  EXPECT_THAT(scene.materials[mesh.material].texture, EndsWith("textures/base/stone.jpg"));
  ASSERT_EQ(mesh.irradiance.size(), mesh.positions.size());
  std::set<float> heights;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    heights.insert(p.z());
    if (p.z() != 0) {  // the colours of its vertices are white
      EXPECT_NEAR(mesh.irradiance[i].x(), std::pow(2, 2.2), 1e-3);
      continue;
    }
    // u runs along y, v along x; pixel k has its centre at (k + 1/2) / 128.
    const auto level = [](float metres) {
      const double value = std::clamp(metres / kSide * 128 - 0.5, 0.0, 127.0);
      return std::pow(std::min(4 * value / 255, 2.0), 2.2);
    };
    EXPECT_NEAR(mesh.irradiance[i].x(), level(p.y()), 1e-3);
    EXPECT_NEAR(mesh.irradiance[i].y(), level(p.x()), 1e-3);
    EXPECT_NEAR(mesh.texture_coordinates[i].x(), p.y() / kSide, 1e-5);
    EXPECT_NEAR(mesh.texture_coordinates[i].y(), -p.x() / kSide, 1e-5);
  }
  EXPECT_THAT(heights, ElementsAre(0, 100));
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3f& p = mesh.positions[a];
    const Vector3f normal = (mesh.positions[b] - p).cross(mesh.positions[c] - p);
    EXPECT_GT(normal.z(), 0);
    area += normal.norm() / 2;
    if (p.z() != 0) continue;
    for (const auto& [i, k] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      EXPECT_LE((mesh.positions[i] - mesh.positions[k]).norm(), 12);
  }
  EXPECT_NEAR(area, 2 * kSide * kSide, 1);
  ASSERT_EQ(scene.starts.size(), 1U);
  EXPECT_TRUE(scene.starts[0].isApprox(Vector3f(32, 16, 0)));
}

TEST_F(QuakeSceneTest, VerticesWithoutANormalTakeThatOfTheirFace) {
  QuakeBspBuilder map;
  map.AddQuad(map.AddShader("textures/base/stone"), Floor(0), Vector3f::Zero(), -3);
  map.EndModel();
  const SourceScene scene = ReadQuakeScene(Write("maps/plain.bsp", map.Bytes()));
  ASSERT_EQ(scene.meshes[0].normals.size(), 4U);
  for (const Vector3f& normal : scene.meshes[0].normals)
    EXPECT_TRUE(normal.isApprox(Vector3f::UnitZ()));
}

TEST_F(QuakeSceneTest, MissingTexturesAreNamed) {
  const std::filesystem::path file = Write("maps/small.bsp", SmallMap().Bytes());
  std::vector<std::string> missing;
  MakeScenery(ReadMeshFile(file), file.parent_path(), {.up = UpAxis::kZ}, &missing);
  EXPECT_THAT(missing, ElementsAre(HasSubstr("textures/base/Stone: no such file")));
}

TEST_F(QuakeSceneTest, SurfacesThatShineAreNotLit) {
  Write("scripts/base.shader",
        "textures/base/stone\n{\n{\nmap textures/base/lava.tga\ntcMod scale 2 3\n}\n}\n");
  const SourceScene scene = ReadQuakeScene(Write("maps/small.bsp", SmallMap().Bytes()));
  const SourceMesh& mesh = scene.meshes[0];
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_EQ(mesh.irradiance[i], Vector3f::Ones());
    EXPECT_NEAR(mesh.texture_coordinates[i].x(), 2 * mesh.positions[i].y() / kSide, 1e-5);
  }
}

TEST_F(QuakeSceneTest, CutOffFilesAreRefusedWhereverTheyEnd) {
  QuakeBspBuilder map = SmallMap();
  const std::string good = map.Bytes();
  const size_t without_page = good.size() - kLightPageBytes;
  for (size_t length = 0; length < good.size(); length += length < without_page + 8 ? 1 : 997)
    ASSERT_THAT(Problem(good.substr(0, length)), HasSubstr("bad.bsp: ")) << length;
  EXPECT_EQ(Problem(good), "");
}

TEST_F(QuakeSceneTest, DamagedFilesAreRefusedOrReadButNeverRunAway) {
  QuakeBspBuilder map = SmallMap();
  map.light_pages.clear();  // so that most changes meet something
  const std::string good = map.Bytes();
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    const auto at = static_cast<size_t>(random.Int(static_cast<int>(bad.size()) - 4));
    const int value = random.Chance(0.5) ? random.Int(256) : static_cast<int>(random.Next());
    if (random.Chance(0.5)) {
      bad[at] = static_cast<char>(value);
    } else {
      bad.replace(at, 4, QuakeBspBuilder::Int(value));
    }
    Problem(bad);  // anything but UserError fails the test
  }
}

TEST_F(QuakeSceneTest, RefusalsNameWhatIsWrong) {
  const std::string good = SmallMap().Bytes();
  EXPECT_THAT(Problem("VBSP" + good.substr(4)), HasSubstr("it does not begin with IBSP"));
  std::string bad = good;
  bad[4] = 47;
  EXPECT_THAT(Problem(bad), HasSubstr("is a map of version 47: only version 46"));
  QuakeBspBuilder map = SmallMap();
  map.AddFace(1, 0, 0, 4, {0, 1, 9}, -1);
  EXPECT_THAT(Problem(map.Bytes()), HasSubstr("a corner of a face is none of its vertices"));
  map = SmallMap();
  map.AddFace(1, 7, 0, 4, {0, 1, 2}, -1);
  EXPECT_THAT(Problem(map.Bytes()), HasSubstr("a surface that does not exist"));
  map = SmallMap();
  map.AddPatch(0, 0, 2, 2, -1);
  EXPECT_THAT(Problem(map.Bytes()), HasSubstr("a patch has an impossible size"));
  map = SmallMap();
  map.AddFace(1, 0, 0, 4, {0, 1, 2}, 1);
  EXPECT_THAT(Problem(map.Bytes()), HasSubstr("a page of light that does not exist"));
  map = SmallMap();
  map.AddVertex({NAN, 0, 0}, {0, 0}, {0, 0}, {0, 0, 1});
  EXPECT_THAT(Problem(map.Bytes()), HasSubstr("the position of a vertex is out of range"));
}

}  // namespace
}  // namespace orb360::town
