#include "slam/io/export/point_selection.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "slam/io/ply.h"
#include "tests/slam/geometry/random_geometry.h"
#include "tests/slam/io/synthetic_model.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

std::vector<ColoredPoint> Ball(int count) {
  RandomGeometry random(5);
  std::vector<ColoredPoint> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({random.Point(9.9, 10.0).cast<float>(), {200, 100, 50}});
  }
  return points;
}

TEST(PointSelection, FewPointsOfACloudStayAsTheyAre) {
  const TempFolder folder;
  const std::vector<ColoredPoint> points = Ball(500);
  WritePly(folder / "cloud.ply", points);
  const std::vector<ColoredLandmark> thinned = ReadThinnedCloud(folder / "cloud.ply", 500);
  ASSERT_EQ(thinned.size(), 500u);
  std::set<float> before;
  std::set<float> after;
  for (const ColoredPoint& point : points) before.insert(point.position.x());
  for (const ColoredLandmark& point : thinned) after.insert(static_cast<float>(point.position.x()));
  EXPECT_EQ(before, after);
}

TEST(PointSelection, AThinnedCloudCoversTheSameSurfaceWithNearlyAsManyPointsAsAllowed) {
  const TempFolder folder;
  const std::vector<ColoredPoint> points = Ball(40'000);
  WritePly(folder / "cloud.ply", points);
  const std::vector<ColoredLandmark> thinned = ReadThinnedCloud(folder / "cloud.ply", 1000);
  EXPECT_LE(thinned.size(), 1000u);
  EXPECT_GT(thinned.size(), 600u);
  for (const ColoredLandmark& point : thinned) {
    EXPECT_NEAR(point.position.norm(), 9.9, 0.15);
    EXPECT_EQ(point.color, (Color{200, 100, 50}));
  }
  // A cube of a sphere of radius 10 with 1000 cubes has a side of about 1.1.
  for (size_t i = 0; i < points.size(); i += 100) {
    double nearest = 1e9;
    for (const ColoredLandmark& point : thinned) {
      nearest = std::min(nearest, (point.position - points[i].position.cast<double>()).norm());
    }
    EXPECT_LT(nearest, 2.0);
  }
}

TEST(PointSelection, PointsOfAnyDistanceAndUnitAreThinned) {
  CloudThinning thinning(10);
  for (int i = 0; i < 1000; ++i) {
    thinning.Add({Eigen::Vector3d(1e7 * i, -3e5 * i, 0.1), {1, 2, 3}});
  }
  const std::vector<ColoredLandmark> thinned = thinning.Take();
  EXPECT_LE(thinned.size(), 10u);
  EXPECT_GE(thinned.size(), 5u);
}

TEST(PointSelection, ASurfaceCloudGivesThePositionsAndColoursThatWereWritten) {
  const TempFolder folder;
  SurfacePoint point;
  point.position = {1, 2, 3};
  point.normal = {0, 0, 1};
  point.rgb = {9, 8, 7};
  SurfacePlyWriter writer(folder / "cloud.ply", 0.05);
  for (int i = 0; i < 70'000; ++i) {  // several pieces
    point.position.x() = static_cast<float>(i);
    writer.Append({&point, 1});
  }
  writer.Commit();
  int count = 0;
  ReadCloudPoints(folder / "cloud.ply", [&](const SurfacePoint& read) {
    EXPECT_EQ(read.position, Eigen::Vector3f(static_cast<float>(count), 2, 3));
    EXPECT_EQ(read.rgb, point.rgb);
    ++count;
  });
  EXPECT_EQ(count, 70'000);
}

TEST(PointSelection, WhatIsNoCloudIsRefused) {
  const TempFolder folder;
  WritePly(folder / "cloud.ply", Ball(10));
  const auto refusal = [&](const std::string& name) {
    return MessageOf<UserError>([&] { ReadThinnedCloud(folder / name, 10); });
  };
  EXPECT_NE(refusal("none.ply").find("none.ply: cannot be opened"), std::string::npos);
  CopyTruncated(folder / "cloud.ply", folder / "cut.ply", 0.7);
  EXPECT_NE(refusal("cut.ply").find("is not a cloud that orb360 wrote"), std::string::npos);
  WriteText(folder / "text.ply", "ply\nformat ascii 1.0\n");
  EXPECT_NE(refusal("text.ply").find("is not a cloud that orb360 wrote"), std::string::npos);
}

TEST(PointSelection, TheMostObservedLandmarksAreKeptWithTheirObservations) {
  const SparseModel model = MakeSyntheticModel({30, 10});
  const auto counts = [](const SparseModel& of) {
    std::vector<int> observed(of.points.size(), 0);
    for (const PosedFrame& frame : of.frames) {
      for (const PointObservation& seen : frame.observations) {
        ++observed[static_cast<size_t>(seen.point)];
      }
    }
    return observed;
  };
  std::vector<int> all = counts(model);
  const SparseModel kept = KeepMostObserved(model, 60);
  ASSERT_EQ(kept.points.size(), 60u);
  std::vector<int> few = counts(kept);
  std::ranges::sort(all, std::greater());
  std::ranges::sort(few, std::greater());
  EXPECT_TRUE(std::equal(few.begin(), few.end(), all.begin()));
  EXPECT_EQ(KeepMostObserved(model, 1000).points.size(), model.points.size());
}

}  // namespace
}  // namespace orb360
