#include "apps/town/import/import_scenery.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "apps/town/render/geometry_image.h"
#include "apps/town/render/stage.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const EquirectangularCamera kCamera(128, 64);

class ImportTest : public testing::Test {
 protected:
  ImportTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("import_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ImportTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  Scenery Import(const std::filesystem::path& file, const ImportOptions& options = {}) {
    return MakeScenery(ReadMeshFile(file), folder_, options, &missing_);
  }
  std::string Problem(const std::filesystem::path& file) {
    try {
      Import(file);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  /// Every ray that goes down meets the floor at `height` below the camera, and no other ray
  /// meets anything.
  static void ExpectFloor(const Scenery& scenery, double height, double half_width) {
    const RayScene scene(scenery);
    const cv::Mat1f range = RenderGeometry(FrameScene(scene, {}), kCamera, {}).range;
    for (int row = 0; row < range.rows; ++row) {
      for (int column = 0; column < range.cols; ++column) {
        const Eigen::Vector3d d = kCamera.Bearing({column + 0.5, row + 0.5});
        const double distance = d.z() < 0 ? -height / d.z() : 0;
        const double reach = distance * std::max(std::abs(d.x()), std::abs(d.y()));
        if (std::abs(reach - half_width) < 1e-3 * half_width) continue;
        ASSERT_NEAR(range(row, column), reach < half_width ? distance : 0, 1e-3 * distance);
      }
    }
  }

  std::filesystem::path folder_;
  std::vector<std::string> missing_;
};

/// A floor of 8 by 8 units, 2 below the origin, y up.
constexpr const char* kObj =
    "mtllib floor.mtl\nv -4 -2 -4\nv 4 -2 -4\nv 4 -2 4\nv -4 -2 4\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl floor\nf 1/1 2/2 3/3 4/4\n";

TEST_F(ImportTest, AnObjStandsWithYUpwardUnlessAskedOtherwise) {
  Write("floor.mtl", "newmtl floor\nKd 0.5 0.25 1\n");
  const std::filesystem::path file = Write("floor.obj", kObj);
  ExpectFloor(Import(file), 2, 4);
  ExpectFloor(Import(file, {.scale = 10}), 20, 40);
  // With z upward it is a wall.
  const Scenery wall = Import(file, {.up = UpAxis::kZ});
  for (const Vector3f& p : wall.fixed.positions) EXPECT_EQ(p.y(), -2);
  EXPECT_TRUE(missing_.empty());
  const auto& tint = wall.fixed.vertices[0].tint;  // the square root of the colour
  EXPECT_NEAR(std::pow(tint[0] / 255.0, 2), 0.5, 0.01);
  EXPECT_NEAR(std::pow(tint[1] / 255.0, 2), 0.25, 0.01);
}

TEST_F(ImportTest, TexturesLieTheRightWayRoundAndTheirHolesAreHoles) {
  // Red at the top left, a hole at the bottom right; v grows upward in OBJ.
  cv::Mat4b image(2, 2, cv::Vec4b(0, 255, 0, 255));
  image(0, 0) = {0, 0, 255, 255};
  image(1, 1) = {0, 0, 0, 0};
  cv::imwrite((folder_ / "floor.png").string(), image);
  Write("floor.mtl", "newmtl floor\nmap_Kd floor.png\n");
  const Scenery scenery = Import(Write("floor.obj", kObj));
  ASSERT_EQ(scenery.fixed.opaque_count, 0U);  // its material has a hole
  const Texture& texture =
      scenery.palette.textures[scenery.palette[scenery.fixed.triangles[0].material].texture];
  EXPECT_TRUE(texture.Covers(0.25F, 0.75F));
  EXPECT_GT(texture.Sample(0.25F, 0.75F, 0).r, 0.9F);
  EXPECT_FALSE(texture.Covers(0.75F, 0.25F));
  // The corner with u and v near (1, 0) is at x = 4, z = -4 of the file.
  const RayScene scene(scenery);
  const auto meets = [&](float x, float y) {
    const Rigid3 above{Eigen::Quaterniond::Identity(), {x, y, 0}};
    return RenderGeometry(FrameScene(scene, {}), kCamera, above).range(63, 0) > 0;
  };
  EXPECT_TRUE(meets(-2, 2));
  EXPECT_FALSE(meets(2, 2));
}

TEST_F(ImportTest, MissingTexturesAreNamedOnceAndGrey) {
  Write("floor.mtl", "newmtl floor\nmap_Kd lost.png\n");
  const Scenery scenery = Import(Write("floor.obj", kObj));
  EXPECT_THAT(missing_, ElementsAre(HasSubstr("lost.png: no such file")));
  EXPECT_EQ(scenery.fixed.triangles.size(), 2U);
}

TEST_F(ImportTest, TexturesAreLookedForByNameInOtherFoldersToo) {
  const cv::Mat3b red(2, 2, cv::Vec3b(0, 0, 255));
  std::filesystem::create_directories(folder_ / "elsewhere");
  cv::imwrite((folder_ / "elsewhere" / "floor.png").string(), red);
  Write("floor.mtl", "newmtl floor\nmap_Kd C:\\art\\floor.png\n");
  const std::filesystem::path file = Write("floor.obj", kObj);
  EXPECT_FLOAT_EQ(Import(file, {.texture_folders = {folder_ / "elsewhere"}})
                      .palette.textures.back()
                      .Sample(0.5F, 0.5F, 0)
                      .r,
                  1);
  EXPECT_TRUE(missing_.empty());
  // Where TORCS keeps what its circuits share.
  const std::filesystem::path track = folder_ / "tracks" / "road" / "track";
  std::filesystem::create_directories(track);
  std::filesystem::create_directories(folder_ / "data" / "textures");
  cv::imwrite((folder_ / "data" / "textures" / "floor.png").string(), red);
  MakeScenery(ReadMeshFile(file), track, {}, &missing_);
  EXPECT_TRUE(missing_.empty());
}

TEST_F(ImportTest, NoFringeOfTheHiddenColourShowsAroundAHole) {
  cv::Mat4b image(8, 8, cv::Vec4b(255, 255, 255, 0));  // white where nothing is
  image.colRange(0, 4) = cv::Vec4b(0, 0, 0, 255);
  cv::imwrite((folder_ / "leaf.png").string(), image);
  Write("floor.mtl", "newmtl floor\nmap_Kd leaf.png\n");
  const Scenery scenery = Import(Write("floor.obj", kObj));
  const Texture& texture = scenery.palette.textures.back();
  for (float u = 0; u < 1; u += 0.01F) EXPECT_LT(texture.Sample(u, 0.5F, 0).r, 0.01F) << u;
}

TEST_F(ImportTest, ABlackFactorOnATextureIsIgnoredAsManyProgramsWriteIt) {
  cv::imwrite((folder_ / "floor.png").string(), cv::Mat3b(2, 2, cv::Vec3b(9, 9, 9)));
  Write("floor.mtl", "newmtl floor\nKd 0 0 0\nmap_Kd floor.png\n");
  EXPECT_EQ(Import(Write("floor.obj", kObj)).fixed.vertices[0].tint[0], 255);
}

/// A triangle of glTF with a texture inside the file, half of it transparent.
std::string GltfWithImage(const std::filesystem::path& folder, const std::string& alpha_mode) {
  std::string buffer;
  for (const float x : {-1.0F, 0.0F, 1.0F, 1.0F,  0.0F, 1.0F, 0.0F,  0.0F, -1.0F,  // positions
                        0.0F,  0.0F, 1.0F, 0.0F,  0.0F, 1.0F,                      // uv, v downward
                        0.25F, 1.0F, 1.0F, 0.25F, 1.0F, 1.0F, 0.25F, 1.0F, 1.0F})  // colours
    buffer.append(reinterpret_cast<const char*>(&x), sizeof x);
  cv::Mat4b image(2, 2, cv::Vec4b(0, 0, 255, 255));
  image.row(1) = cv::Vec4b(255, 0, 0, 0);
  std::vector<uchar> png;
  cv::imencode(".png", image, png);
  buffer.append(png.begin(), png.end());
  std::ofstream(folder / "all.bin", std::ios::binary) << buffer;
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},
                              "material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"alphaMode":")" +
         alpha_mode + R"("}],
    "textures":[{"source":0}],"images":[{"bufferView":3,"mimeType":"image/png"}],
    "buffers":[{"uri":"all.bin","byteLength":)" +
         std::to_string(buffer.size()) + R"(}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},
                   {"buffer":0,"byteOffset":60,"byteLength":36},
                   {"buffer":0,"byteOffset":96,"byteLength":)" +
         std::to_string(png.size()) + R"(}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                  "min":[-1,0,-1],"max":[1,0,1]},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},
                 {"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}]})";
}

TEST_F(ImportTest, GltfBringsItsImagesAndColoursAndSaysWhatCoverageMeans) {
  const Scenery masked = Import(Write("masked.gltf", GltfWithImage(folder_, "MASK")));
  EXPECT_TRUE(missing_.empty());
  ASSERT_EQ(masked.fixed.triangles.size(), 1U);
  EXPECT_EQ(masked.fixed.opaque_count, 0U);
  EXPECT_NEAR(std::pow(masked.fixed.vertices[0].tint[0] / 255.0, 2), 0.25, 0.01);
  const Texture& texture =
      masked.palette.textures[masked.palette[masked.fixed.triangles[0].material].texture];
  // The image's upper row is the red one; glTF's (0, 0) is its upper left corner.
  const Vertex& first = masked.fixed.vertices[0];
  EXPECT_GT(texture.Sample(first.u + 0.25F, first.v - 0.25F, 0).r, 0.9F);
  EXPECT_TRUE(texture.Covers(first.u + 0.25F, first.v - 0.25F));
  const Scenery opaque = Import(Write("opaque.gltf", GltfWithImage(folder_, "OPAQUE")));
  EXPECT_EQ(opaque.fixed.opaque_count, 1U);
}

TEST_F(ImportTest, GltfIsReadWithItsNodesTransforms) {
  // One triangle under a node that lowers it by two and makes it a hundred times as large.
  std::string buffer;
  for (const float x : {-1.0F, 0.0F, 1.0F, 1.0F, 0.0F, 1.0F, 0.0F, 0.0F, -1.0F})
    buffer.append(reinterpret_cast<const char*>(&x), sizeof x);
  std::ofstream(folder_ / "triangle.bin", std::ios::binary) << buffer;
  const Scenery scenery = Import(Write("triangle.gltf", R"({"asset":{"version":"2.0"},
    "scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"translation":[0,-2,0],"scale":[100,1,100]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "buffers":[{"uri":"triangle.bin","byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                  "min":[-1,0,-1],"max":[1,0,1]}]})"));
  ASSERT_EQ(scenery.fixed.positions.size(), 3U);
  EXPECT_TRUE(scenery.fixed.positions[0].isApprox(Vector3f(-100, -100, -2)));
}

/// The floor as a strip of TORCS: normals after the positions, two textures, more coordinates.
constexpr const char* kAcc =
    "AC3Db\nMATERIAL \"\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 1 trans 0\n"
    "OBJECT world\nkids 1\nOBJECT poly\nname \"TKMN1\"\nloc 0 -2 0\n"
    "texture \"floor.rgb\" base\ntexture empty_texture_no_mapping tiled\nnumvert 6\n"
    "-4 0 -4 0 1 0\n-4 0 4 0 1 0\n0 0 -4 0 1 0\n0 0 4 0 1 0\n4 0 -4 0 1 0\n4 0 4 0 1 0\n"
    "numsurf 1\nSURF 0x14\nmat 0\nrefs 6\n0 0 0 7 7\n1 0 1 7 7\n2 0.5 0 7 7\n3 0.5 1 7 7\n"
    "4 1 0 7 7\n5 1 1 7 7\nkids 0\n";

TEST_F(ImportTest, StripsOfAc3dFillTheirSurface) {
  const Scenery scenery = Import(Write("floor.acc", kAcc));
  ExpectFloor(scenery, 2, 4);
  EXPECT_EQ(scenery.fixed.triangles.size(), 4U);
  EXPECT_EQ(scenery.fixed.vertices[2].u, 0.5F);
  EXPECT_THAT(missing_, ElementsAre(HasSubstr("floor.rgb")));
}

TEST_F(ImportTest, DamagedFilesAreRefusedWithTheirNameAndLine) {
  const std::string good = kAcc;
  std::string bad = good;
  bad[bad.find("3 0.5 1")] = '9';
  EXPECT_THAT(Problem(Write("a.acc", bad)), HasSubstr("a.acc: line 24: there is no such vertex"));
  EXPECT_THAT(Problem(Write("b.acc", good.substr(0, good.find("refs")))),
              HasSubstr("b.acc: line 19: the file ends too early"));
  bad = good;
  bad.replace(bad.find("refs 6"), 6, "refs -1");
  EXPECT_THAT(Problem(Write("e.acc", bad)), HasSubstr("e.acc: line 20: expected a number of corn"));
  bad = good;
  bad.replace(bad.find("refs 6"), 6, "refs 2000000000");
  EXPECT_THAT(Problem(Write("f.acc", bad)), HasSubstr("f.acc: line 27: expected the number of"));
  bad = "AC3Db\n";
  for (int i = 0; i < 100000; ++i) bad += "OBJECT group\nkids 1\n";
  EXPECT_THAT(Problem(Write("g.acc", bad)), HasSubstr("nested too deeply"));
  EXPECT_THAT(Problem(Write("c.acc", "solid cube\n")), HasSubstr("is not an AC3D file"));
  EXPECT_THAT(Problem(Write("d.obj", "v 0 0 0\n")), HasSubstr("d.obj: "));
  EXPECT_THAT(Problem(folder_ / "none.obj"), HasSubstr("none.obj: no such file"));
}

}  // namespace
}  // namespace orb360::town
