#include "apps/town/import/spm_mesh.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/apps/town/import/spm_bytes.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

class ReadSpmTest : public testing::Test {
 protected:
  ReadSpmTest()
      : file_(std::filesystem::temp_directory_path() /
              ("spm_test_" + std::to_string(getpid()) + ".spm")) {}
  ~ReadSpmTest() override { std::filesystem::remove(file_); }

  std::vector<SpmPart> Read(const std::string& bytes) {
    std::ofstream(file_, std::ios::binary) << bytes;
    return ReadSpm(file_);
  }
  std::string Problem(const std::string& bytes) {
    try {
      Read(bytes);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path file_;
};

void ExpectTriangle(const SourceMesh& mesh) {
  ASSERT_EQ(mesh.positions.size(), 3U);
  EXPECT_EQ(mesh.positions[1], Eigen::Vector3f(1, 2, 4));
  EXPECT_EQ(mesh.positions[2], Eigen::Vector3f(1, 3, 3));
  EXPECT_EQ(mesh.normals[2], Eigen::Vector3f(-1, 0, 0));
  EXPECT_EQ(mesh.colours[0], Eigen::Vector3f(1, 1, 1));
  EXPECT_TRUE(mesh.colours[1].isApprox(Eigen::Vector3f(1, 0.2F, 0)));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}}));
}

TEST_F(ReadSpmTest, ReadsPositionsNormalsColoursAndTextureCoordinates) {
  for (const char* second : {"", "other.png"}) {
    const std::vector<SpmPart> parts = Read(SpmTriangle("wall.png", second));
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0].texture, "wall.png");
    ExpectTriangle(parts[0].mesh);
    EXPECT_EQ(parts[0].mesh.texture_coordinates[1], Eigen::Vector2f(0.5F, 1));  // v turned round
    EXPECT_EQ(parts[0].mesh.texture_coordinates[2], Eigen::Vector2f(0, 0.75F));
  }
}

TEST_F(ReadSpmTest, AMeshWithoutATextureHasNoTextureCoordinates) {
  const std::vector<SpmPart> parts = Read(SpmTriangle(""));
  ExpectTriangle(parts.at(0).mesh);
  EXPECT_TRUE(parts[0].mesh.texture_coordinates.empty());
}

TEST_F(ReadSpmTest, AnimatedMeshesAreReadInTheirRestPose) {
  std::string bytes = SpmTriangle("");
  bytes[2] = 1 << 3 | 1;
  const std::string joints(16, '\x55');
  // Each vertex has 12 bytes of position, 4 of normal, and 1 or 4 of colour; 3 indices follow.
  const size_t end = bytes.size() - 3;
  for (const size_t from_end : {size_t{0}, size_t{17}, size_t{37}})
    bytes.insert(end - from_end, joints);
  ExpectTriangle(Read(bytes + "joints").at(0).mesh);
}

TEST_F(ReadSpmTest, CutOffAnywhereItIsRefused) {
  const std::string good = SpmTriangle("wall.png", "other.png");
  for (size_t size = 0; size < good.size(); ++size)
    EXPECT_THAT(Problem(good.substr(0, size)), HasSubstr("ends too early")) << size;
  EXPECT_THAT(Problem(good + "x"), HasSubstr("bytes after its last mesh"));
}

TEST_F(ReadSpmTest, DamagedFilesAreRefusedWithTheirName) {
  std::string bad = SpmTriangle("");
  bad.back() = 3;
  EXPECT_THAT(Problem(bad), HasSubstr(file_.string() + ": a triangle has a corner that does not"));
  bad = SpmTriangle("");
  bad[2] = 2 << 3 | 2;
  EXPECT_THAT(Problem(bad), HasSubstr("is of version 2 of SPM; only version 1 is read"));
  bad[2] = 1 << 3 | 0;
  EXPECT_THAT(Problem(bad), HasSubstr("is of a kind of SPM mesh that is not read"));
  EXPECT_THAT(Problem("OBJECT"), HasSubstr("does not begin with SP"));
}

TEST_F(ReadSpmTest, AnyBytesAreReadOrRefused) {
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    std::string bytes = SpmTriangle("wall.png");
    bytes[2 + random() % (bytes.size() - 2)] = static_cast<char>(random());
    Problem(bytes);  // throws nothing else
  }
}

}  // namespace
}  // namespace orb360::town
