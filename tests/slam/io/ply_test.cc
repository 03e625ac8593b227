#include "slam/io/ply.h"

#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

TEST(Ply, WritesTheBytesThatTheFormatAsksFor) {
  const TempFolder folder;
  WritePly(folder / "a.ply", std::vector<ColoredPoint>{{{1.0f, -2.0f, 0.5f}, {10, 20, 255}}});
  EXPECT_EQ(ReadText(folder / "a.ply"),
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
                std::string("\x00\x00\x80\x3f\x00\x00\x00\xc0\x00\x00\x00\x3f\x0a\x14\xff", 15));
}

TEST(Ply, ReadsBackAnyNumberOfPoints) {
  const TempFolder folder;
  for (const size_t count : {size_t{0}, size_t{1}, size_t{200000}}) {  // The last: several chunks.
    std::vector<ColoredPoint> points(count);
    for (size_t i = 0; i < count; ++i) {
      points[i].position = Eigen::Vector3f(static_cast<float>(i), 0.5f, -1.0f);
      points[i].rgb = {static_cast<std::uint8_t>(i), 7, 9};
    }
    WritePly(folder / "a.ply", points);
    const std::vector<ColoredPoint> read = ReadPly(folder / "a.ply");
    ASSERT_EQ(read.size(), count);
    for (size_t i = 0; i < count; ++i) {
      ASSERT_EQ(read[i].position, points[i].position);
      ASSERT_EQ(read[i].rgb, points[i].rgb);
    }
  }
}

TEST(Ply, MovesPointsIntoTheFilesWorld) {
  const TempFolder folder;
  const Rigid3 world_from_map{ExpSo3(Eigen::Vector3d::UnitZ() * std::numbers::pi / 2), {5, 0, 0}};
  WritePly(folder / "a.ply", std::vector<ColoredPoint>{{{1, 2, 3}, {}}}, world_from_map);
  EXPECT_LT((ReadPly(folder / "a.ply")[0].position - Eigen::Vector3f(3, 1, 3)).norm(), 1e-6);
}

TEST(Ply, RefusesOtherFiles) {
  const TempFolder folder;
  WritePly(folder / "a.ply", std::vector<ColoredPoint>(3));
  CopyTruncated(folder / "a.ply", folder / "cut.ply", 0.95);
  WriteText(folder / "text.ply", "ply\nformat ascii 1.0\n");
  for (const char* name : {"cut.ply", "text.ply", "absent.ply"}) {
    EXPECT_THAT(MessageOf<UserError>([&] { ReadPly(folder / name); }), testing::HasSubstr(name));
  }
}

TEST(SurfacePly, AloneStatesAVoxelSize) {
  const TempFolder folder;
  WritePly(folder / "landmarks.ply", std::vector<ColoredPoint>(3));
  EXPECT_EQ(VoxelSizeOf(folder / "landmarks.ply"), std::nullopt);
  EXPECT_EQ(VoxelSizeOf(folder / "absent.ply"), std::nullopt);
}

TEST(SurfacePly, WritesTheBytesThatTheFormatAsksFor) {
  const TempFolder folder;
  SurfacePlyWriter writer(folder / "a.ply", 0.05);
  writer.Append(std::vector<SurfacePoint>{{{1.0f, -2.0f, 0.5f}, {0, 0, 1}, {10, 20, 255}, 0.5f}});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.ply"));
  writer.Commit();
  const std::string bytes = ReadText(folder / "a.ply");
  EXPECT_THAT(bytes, testing::StartsWith("ply\nformat binary_little_endian 1.0\ncomment "));
  EXPECT_THAT(bytes, testing::HasSubstr("voxels of 0.05"));
  EXPECT_FLOAT_EQ(static_cast<float>(VoxelSizeOf(folder / "a.ply").value_or(0)), 0.05f);
  EXPECT_THAT(bytes,
              testing::EndsWith("\nelement vertex 1\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "property float nx\nproperty float ny\nproperty float nz\n"
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "property float confidence\nend_header\n" +
                                std::string("\x00\x00\x80\x3f\x00\x00\x00\xc0\x00\x00\x00\x3f"
                                            "\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x80\x3f"
                                            "\x0a\x14\xff\x00\x00\x00\x3f",
                                            31)));
}

TEST(SurfacePly, ReadsBackAnyNumberOfPointsInAnyNumberOfPieces) {
  const TempFolder folder;
  for (const size_t pieces : {size_t{0}, size_t{1}, size_t{3}}) {
    SurfacePlyWriter writer(folder / "a.ply", 0.05);
    std::vector<SurfacePoint> points(70000);  // More than is written at once.
    for (size_t i = 0; i < pieces; ++i) {
      points[5].position.x() = static_cast<float>(i);
      points[5].confidence = 0.25f;
      writer.Append(points);
    }
    writer.Commit();
    EXPECT_EQ(writer.num_points(), pieces * points.size());
    const std::vector<SurfacePoint> read = ReadSurfacePly(folder / "a.ply");
    ASSERT_EQ(read.size(), pieces * points.size());
    for (size_t i = 0; i < pieces; ++i) {
      EXPECT_EQ(read[i * points.size() + 5].position.x(), static_cast<float>(i));
      EXPECT_EQ(read[i * points.size() + 5].confidence, 0.25f);
    }
  }
}

TEST(SurfacePly, RefusesOtherFiles) {
  const TempFolder folder;
  WritePly(folder / "sparse.ply", std::vector<ColoredPoint>(3));
  SurfacePlyWriter writer(folder / "a.ply", 0.05);
  writer.Append(std::vector<SurfacePoint>(10));
  writer.Commit();
  CopyTruncated(folder / "a.ply", folder / "cut.ply", 0.95);
  EXPECT_TRUE(IsSurfacePly(folder / "a.ply"));
  EXPECT_FALSE(IsSurfacePly(folder / "sparse.ply"));
  EXPECT_FALSE(IsSurfacePly(folder / "absent.ply"));
  for (const char* name : {"sparse.ply", "cut.ply", "absent.ply"}) {
    EXPECT_THAT(MessageOf<UserError>([&] { ReadSurfacePly(folder / name); }),
                testing::HasSubstr(name));
  }
}

}  // namespace
}  // namespace orb360
