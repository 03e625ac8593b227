#include "slam/io/export/las.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/ply.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Writes points as orb360 run does without a network.
void WriteCloud(const std::filesystem::path& path, const std::vector<Eigen::Vector3f>& positions) {
  std::vector<ColoredPoint> points;
  for (const Eigen::Vector3f& position : positions) points.push_back({position, {10, 20, 30}});
  WritePly(path, points);
}

/// A georeference at a place: the world's axes x and y point to the north and the west, and its
/// unit is two metres.
Georeference At(const GeodeticPoint& origin) {
  Georeference georeference;
  georeference.origin = origin;
  georeference.alignment.local_from_path = {
      2,
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
      {3, 4, 5}};
  return georeference;
}

TEST(Las, WithoutAGeoreferenceCoordinatesAreThoseOfTheRun) {
  const TempFolder folder;
  WriteCloud(folder / "cloud.ply", {{1, -2, 3}, {-40, 8, 0.5F}});
  const LasCloud cloud = MeasureCloud(folder / "cloud.ply", std::nullopt);
  EXPECT_EQ(cloud.description.num_points, 2U);
  EXPECT_EQ(cloud.description.bounds.min(), Eigen::Vector3d(-40, -2, 0.5));
  EXPECT_EQ(cloud.description.bounds.max(), Eigen::Vector3d(1, 8, 3));
  EXPECT_FALSE(cloud.epsg);
  EXPECT_EQ(cloud.description.wkt, "");
  EXPECT_FALSE(cloud.description.has_confidence);
}

TEST(Las, OnEarthEastingIsThatOfUtmAndHeightThatOfTheOrigin) {
  if (!Projection::IsAvailable()) GTEST_SKIP() << "this build has no PROJ";
  const TempFolder folder;
  // On the central meridian of a zone, where grid north is north, and a metre east is 0.9996 m.
  WriteCloud(folder / "cloud.ply", {{0, 0, 0}, {50, 0, 0}, {0, -25, 1}});
  const LasCloud cloud = MeasureCloud(folder / "cloud.ply", At({0, 9, 400}));
  EXPECT_EQ(cloud.epsg, 32632);
  EXPECT_THAT(cloud.description.wkt, HasSubstr("UTM zone 32N"));
  const Eigen::Vector3d at_zero = cloud.file_from_world({0, 0, 0});
  EXPECT_NEAR(at_zero.x(), 500000 + 0.9996 * 3, 1e-3);
  EXPECT_NEAR(at_zero.y(), 0.9996 * 4, 1e-3);
  EXPECT_NEAR(at_zero.z(), 405, 1e-4);
  // x of the world is north, two metres for each unit; the Earth falls off by 0.8 mm in 100 m.
  EXPECT_NEAR(cloud.description.bounds.max().y(), 0.9996 * 104, 2e-2);
  // -y is east, and the height over the ellipsoid grows with z.
  EXPECT_NEAR(cloud.description.bounds.max().x(), 500000 + 0.9996 * 53, 1e-2);
  EXPECT_NEAR(cloud.description.bounds.max().z(), 407, 1e-3);
}

TEST(Las, NearAPoleCoordinatesAreLocalBecauseUtmIsNotDefined) {
  const TempFolder folder;
  WriteCloud(folder / "cloud.ply", {{1, 0, 0}});
  const LasCloud cloud = MeasureCloud(folder / "cloud.ply", At({-89, 10, 2800}));
  EXPECT_FALSE(cloud.epsg);
  EXPECT_EQ(cloud.description.wkt, "");
  EXPECT_LT((cloud.description.bounds.min() - Eigen::Vector3d(3, 6, 5)).norm(), 1e-12);
}

TEST(Las, PointsAreWrittenInTheirOrderWithWhatTheCloudKnows) {
  const TempFolder folder;
  constexpr size_t kCount = 70'000;  // more than one piece of the file, and than one call
  SurfacePlyWriter surface(folder / "cloud.ply", 0.05);
  std::vector<SurfacePoint> points(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    points[i].position = {0.001F * static_cast<float>(i), 0, -7};
    points[i].confidence = 1.0F / static_cast<float>(i + 1);
  }
  surface.Append(points);
  surface.Commit();
  std::vector<uint64_t> calls;
  const auto progress = [&](uint64_t done) { calls.push_back(done); };
  const LasCloud cloud = MeasureCloud(folder / "cloud.ply", std::nullopt, progress);
  WriteLas(cloud, folder / "cloud.las", progress);
  EXPECT_THAT(calls, testing::ElementsAre(65536, 65536));
  const std::string bytes = ReadText(folder / "cloud.las");
  constexpr size_t kPoint = 40;
  ASSERT_EQ(bytes.size(), 375 + 54 + 192 + kCount * kPoint);
  for (size_t i = 0; i < kCount; i += 999) {
    const char* point = bytes.data() + bytes.size() - (kCount - i) * kPoint;
    int32_t x = 0;
    float confidence = 0;
    std::memcpy(&x, point, sizeof x);
    std::memcpy(&confidence, point + 36, sizeof confidence);
    ASSERT_EQ(x, static_cast<int32_t>(i) - 35000) << "millimetres from the middle, 35 m";
    ASSERT_EQ(confidence, points[i].confidence);
  }
}

TEST(Las, ACloudThatIsMissingEmptyOrDamagedIsRefused) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& name) {
    return MessageOf<UserError>([&] { MeasureCloud(folder / name, std::nullopt); });
  };
  EXPECT_THAT(refusal("none.ply"),
              AllOf(HasSubstr("none.ply: cannot be opened"), HasSubstr("`orb360 run`")));
  WriteCloud(folder / "empty.ply", {});
  EXPECT_THAT(refusal("empty.ply"), HasSubstr("empty.ply: has no points"));
  WriteCloud(folder / "cloud.ply", {{1, 2, 3}, {4, 5, 6}});
  CopyTruncated(folder / "cloud.ply", folder / "cut.ply", 0.9);
  EXPECT_THAT(refusal("cut.ply"), HasSubstr("is damaged; run `orb360 run` again"));
  WriteCloud(folder / "nan.ply", {{1, 2, 3}, {4, std::numeric_limits<float>::quiet_NaN(), 6}});
  EXPECT_THAT(refusal("nan.ply"), HasSubstr("nan.ply: is damaged (point 1 is nowhere)"));
}

TEST(Las, WhatStopsTheProgressLeavesNoFile) {
  const TempFolder folder;
  WriteCloud(folder / "cloud.ply", std::vector<Eigen::Vector3f>(70'000, {1, 2, 3}));
  const LasCloud cloud = MeasureCloud(folder / "cloud.ply", std::nullopt);
  std::filesystem::create_directory(folder / "out");
  EXPECT_THROW(WriteLas(cloud, folder / "out/cloud.las", [](uint64_t) { throw 1; }), int);
  EXPECT_TRUE(std::filesystem::is_empty(folder / "out"));
}

}  // namespace
}  // namespace orb360
