#include "apps/town/import/supertuxkart_scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "apps/town/import/import_scenery.h"
#include "tests/apps/town/import/spm_bytes.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A folder like the game's data, with the track `here`.
class KartSceneTest : public testing::Test {
 protected:
  KartSceneTest()
      : data_(std::filesystem::temp_directory_path() / ("kart_test_" + std::to_string(getpid()))) {
    Write("tracks/here/ground.spm", SpmTriangle("ground.png"));
  }
  ~KartSceneTest() override { std::filesystem::remove_all(data_); }

  void Write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((data_ / name).parent_path());
    std::ofstream(data_ / name, std::ios::binary) << bytes;
  }
  /// Reads a scene with the track's model and more elements.
  SourceScene Read(const std::string& elements, const std::string& in_track = "") const {
    Write("tracks/here/scene.xml", "<?xml version=\"1.0\"?><scene><track model=\"ground.spm\">" +
                                       in_track + "</track>" + elements + "</scene>");
    return ReadMeshFile(data_ / "tracks/here/scene.xml");
  }
  std::string Problem(const std::string& elements) const {
    try {
      Read(elements);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path data_;
};

void ExpectPositions(const SourceMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  EXPECT_TRUE(mesh.positions.at(0).isApprox(a, 1e-5F)) << mesh.positions[0].transpose();
  EXPECT_TRUE(mesh.positions.at(1).isApprox(b, 1e-5F)) << mesh.positions[1].transpose();
}

TEST_F(KartSceneTest, AxesBecomeRightHandedAndTrianglesKeepTheirFronts) {
  const SourceScene scene = Read("");
  ASSERT_EQ(scene.meshes.size(), 1U);
  ExpectPositions(scene.meshes[0], {1, 2, -3}, {1, 2, -4});
  // Its front looks along -x, as the normals in the file do.
  const auto& [a, b, c] = scene.meshes[0].triangles.at(0);
  const auto& p = scene.meshes[0].positions;
  const Eigen::Vector3f front = (p[b] - p[a]).cross(p[c] - p[a]);
  EXPECT_LT(front.x(), 0);
  EXPECT_TRUE(scene.meshes[0].normals[0].isApprox(Eigen::Vector3f(-1, 0, 0)));
}

TEST_F(KartSceneTest, ObjectsAreScaledThenTurnedAboutXYAndZThenMoved) {
  Write("tracks/here/box.spm", SpmTriangle("ground.png"));
  const std::string box = R"(<object type="animation" model="box.spm" )";
  const SourceScene scene =
      Read(box + R"(xyz="10 20 30" hpr="90 0 0" scale="1 1 2"/>)" + box + R"(hpr="0 90 0"/>)" +
           box + R"(hpr="0 0 90"/>)" + box + R"(hpr="90 90 0"/>)");
  ASSERT_EQ(scene.meshes.size(), 5U);
  // About x, y goes to z; about y, z goes to x; about z, x goes to y.
  ExpectPositions(scene.meshes[1], {11, 20 - 6, -(30 + 2)}, {11, 20 - 8, -(30 + 2)});
  ExpectPositions(scene.meshes[2], {3, 2, 1}, {4, 2, 1});
  ExpectPositions(scene.meshes[3], {-2, 1, -3}, {-2, 1, -4});
  ExpectPositions(scene.meshes[4], {2, -3, 1}, {2, -4, 1});  // first about x
}

TEST_F(KartSceneTest, NodesOfTheLibraryMayHoldOthersAndShowTheirFinestModel) {
  Write("library/post/post.spm", SpmTriangle("ground.png"));
  Write("library/post/coarse.spm", SpmTriangle("ground.png"));
  Write("library/post/node.xml",
        R"(<scene><lod><group name="g">
           <static-object lod_distance="90" model="coarse.spm"/>
           <static-object lod_distance="30" model="post.spm"/></group></lod>
           <object type="animation" lod_instance="true" lod_group="g" xyz="1 0 0"/></scene>)");
  Write("library/fence/node.xml", R"(<scene><library name="post" hpr="0 90 0"/></scene>)");
  const SourceScene scene = Read(R"(<library name="fence" xyz="0 5 0" scale="2 2 2"/>)");
  ASSERT_EQ(scene.meshes.size(), 2U);
  EXPECT_EQ(scene.meshes[1].name, "post.spm");
  // (1, 2, 3) + (1, 0, 0), turned to (3, 2, -2), doubled, and raised.
  ExpectPositions(scene.meshes[1], {6, 9, 4}, {8, 9, 4});
  Write("library/fence/node.xml", R"(<scene><library name="fence"/></scene>)");
  EXPECT_THAT(Problem(R"(<library name="fence"/>)"), HasSubstr("nested too deeply"));
}

TEST_F(KartSceneTest, WaterIsLiquidAndTheTrackMayLieInASubfolder) {
  Write("tracks/here/pool.spm", SpmTriangle("water.png"));
  const SourceScene scene = Read(R"(<water model="pool.spm"/>)");
  ASSERT_EQ(scene.meshes.size(), 2U);
  EXPECT_FALSE(scene.materials[scene.meshes[0].material].is_liquid);
  EXPECT_TRUE(scene.materials[scene.meshes[1].material].is_liquid);
  Write("tracks/here/deep/ground.spm", SpmTriangle("ground.png"));
  Write("tracks/here/scene.xml", R"(<scene><track model="deep/ground.spm"/></scene>)");
  EXPECT_EQ(ReadMeshFile(data_ / "tracks/here/scene.xml").meshes.size(), 1U);
}

TEST_F(KartSceneTest, RefusesATrackWhoseModelIsNoFile) {
  for (const std::string model : {"", ".", "none.spm"}) {
    Write("tracks/here/scene.xml", "<scene><track model=\"" + model + "\"/></scene>");
    try {
      ReadMeshFile(data_ / "tracks/here/scene.xml");
      ADD_FAILURE() << model;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr("no such file"));
    }
  }
}

TEST_F(KartSceneTest, RefusesNodesThatMultiply) {
  std::string ten;
  for (int level = 6; level >= 0; --level) {
    Write("library/n" + std::to_string(level) + "/node.xml", "<scene>" + ten + "</scene>");
    ten.clear();
    for (int i = 0; i < 10; ++i) ten += "<library name=\"n" + std::to_string(level) + "\"/>";
  }
  EXPECT_THAT(Problem(ten), HasSubstr("multiply to more than 100000"));
}

TEST_F(KartSceneTest, WhatIsNotSeenOrMovesIsLeftOut) {
  const std::string model = R"( model="ground.spm")";
  const SourceScene scene = Read(
      "<object type=\"animation\"" + model + " if=\"isNotReverse\"/>" +
          "<object type=\"animation\"" + model + " if=\"isReverse\"/>" +
          "<object type=\"animation\"" + model + "><curve/></object>" + "<object type=\"movable\"" +
          model + "/>" + "<object type=\"animation\" interaction=\"physicsonly\"" + model + "/>",
      "<static-object interaction=\"physics-only\"" + model + "/>");
  EXPECT_EQ(scene.meshes.size(), 2U);
}

TEST_F(KartSceneTest, ShadersSayWhatTheAlphaOfATextureMeans) {
  for (const char* name : {"leaf", "gloss", "halo"})
    Write(std::string("tracks/here/") + name + ".spm", SpmTriangle(std::string(name) + ".png"));
  cv::Mat4b image(2, 2, cv::Vec4b(0, 0, 255, 255));
  image.row(1) = cv::Vec4b(255, 0, 0, 0);
  cv::imwrite((data_ / "tracks/here/leaf.png").string(), image);
  std::filesystem::create_directories(data_ / "textures");
  for (const char* name : {"gloss", "ground"})
    cv::imwrite((data_ / "textures" / (std::string(name) + ".png")).string(), image);
  Write("tracks/here/materials.xml",
        R"(<materials><material name="Leaf.png" shader="alphatest"/>
           <material name="halo.png" shader="additive"/></materials>)");
  std::vector<std::string> missing;
  const std::string object = R"(<object type="animation" model=")";
  const SourceScene source =
      Read(object + "leaf.spm\"/>" + object + "gloss.spm\"/>" + object + "halo.spm\"/>");
  EXPECT_EQ(source.meshes.size(), 3U);  // a glow has no surface
  const Scenery scenery = MakeScenery(source, data_ / "tracks/here", {}, &missing);
  EXPECT_TRUE(missing.empty());
  EXPECT_EQ(scenery.fixed.opaque_count, 2U);
  // Under an alpha that means something else the colour stays what it is.
  const Material& gloss = scenery.palette[scenery.fixed.triangles[1].material];
  EXPECT_GT(scenery.palette.textures[gloss.texture].Sample(0.25F, 0.25F, 0).b, 0.9F);
}

TEST_F(KartSceneTest, AMaskIsTheAlphaOfItsTexture) {
  Write("tracks/here/leaf.spm", SpmTriangle("leaf.png"));
  Write("tracks/here/materials.xml",
        R"(<materials><material name="leaf.png" mask="mask.png" shader="alphatest"/></materials>)");
  cv::imwrite((data_ / "tracks/here/leaf.png").string(), cv::Mat3b(4, 4, cv::Vec3b(0, 0, 255)));
  cv::Mat1b mask(2, 2, uchar{255});
  mask.row(1) = 0;
  cv::imwrite((data_ / "tracks/here/mask.png").string(), mask);
  const SourceScene scene = Read(R"(<object type="animation" model="leaf.spm"/>)");
  const cv::Mat& image = scene.materials.at(scene.meshes.at(1).material).image;
  ASSERT_EQ(image.type(), CV_8UC4);
  EXPECT_EQ(image.at<cv::Vec4b>(0, 0), cv::Vec4b(0, 0, 255, 255));
  EXPECT_EQ(image.at<cv::Vec4b>(3, 3), cv::Vec4b(0, 0, 255, 0));
}

TEST_F(KartSceneTest, MissingDecorationsAreNamedOnceAndTheTrackIsNeeded) {
  const std::string box = R"(<object type="animation" model="box.spm"/>)";
  const std::string post = R"(<library name="post"/>)";
  EXPECT_THAT(Read(box + box + post + post).missing,
              ElementsAre(HasSubstr("box.spm: no such file"), HasSubstr("node.xml: no such file")));
  EXPECT_THAT(Problem(R"(<object model="ground.spm" xyz="1 2"/>)"),
              HasSubstr("scene.xml: <object> has xyz=\"1 2\": expected three numbers"));
  Write("tracks/here/box.spm", "SP");
  EXPECT_THAT(Problem(box), HasSubstr("box.spm: ends too early"));
  std::filesystem::remove(data_ / "tracks/here/ground.spm");
  EXPECT_THAT(Problem(""), HasSubstr("ground.spm: no such file: the model of the track"));
  Write("tracks/there/scene.xml", "<scene/>");
  EXPECT_THROW(ReadMeshFile(data_ / "tracks/there/scene.xml"), UserError);
  Write("tracks/there/scene.xml", "<scene><track");
  EXPECT_THROW(ReadMeshFile(data_ / "tracks/there/scene.xml"), UserError);
}

}  // namespace
}  // namespace orb360::town
