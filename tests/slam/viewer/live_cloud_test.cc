#include "slam/viewer/live_cloud.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

/// A wall 2 units away all around, of which the colour tells the row, under a sky.
DenseDepth Wall() {
  DenseDepth depth{cv::Mat(64, 128, CV_32FC1, cv::Scalar(2)),
                   cv::Mat(64, 128, CV_32FC1, cv::Scalar(0.95)), cv::Mat(64, 128, CV_8UC3)};
  for (int row = 0; row < 64; ++row) depth.color.row(row).setTo(cv::Scalar(row, 7, 9));
  depth.confidence.rowRange(0, 16).setTo(0.5);
  depth.range.rowRange(16, 20).setTo(0);
  return depth;
}

/// A view as a page reads it.
struct ReadView {
  int frame = 0;
  float x = 0;
  std::uint32_t num_points = 0;
};

std::vector<ReadView> Read(const std::string& bytes, std::uint32_t* end, std::uint32_t* max) {
  const auto uint32 = [&](size_t at) {
    return *ReadNumber<std::uint32_t>(bytes, at, std::endian::little);
  };
  *end = uint32(0);
  *max = uint32(4);
  std::vector<ReadView> views;
  for (size_t at = 8; at < bytes.size(); at += 36 + 16 * views.back().num_points) {
    views.push_back({static_cast<int>(uint32(at)),
                     *ReadNumber<float>(bytes, at + 4, std::endian::little), uint32(at + 32)});
  }
  return views;
}

TEST(ThinView, WhatMovesGivesNone) {
  DenseDepth depth = Wall();
  depth.source =
      cv::Mat(depth.range.size(), CV_8U, cv::Scalar(static_cast<double>(RangeSource::kMeasured)));
  depth.source.rowRange(32, 64) = static_cast<double>(RangeSource::kMovingObject);
  const std::vector<ThinnedView::Point> points = ThinView(depth, 1000);
  EXPECT_GT(points.size(), 300U);
  for (const ThinnedView::Point& point : points) EXPECT_LT(point.color[2], 32);
}

TEST(ThinView, SpreadsPointsEvenlyOverWhatIsKnown) {
  const std::vector<ThinnedView::Point> points = ThinView(Wall(), 1000);
  ASSERT_EQ(points.size(), 1000U);
  int num_low = 0;
  for (const ThinnedView::Point& point : points) {
    EXPECT_NEAR(point.position.norm(), 2, 1e-5f);
    // The row of its colour is that of its direction; those of the sky give none.
    const double latitude = std::asin(point.position.z() / 2);
    EXPECT_NEAR(point.color[2] + 0.5, (0.5 - latitude / M_PI) * 64, 1e-3);
    EXPECT_GE(point.color[2], 20);
    num_low += point.position.z() < 0 ? 1 : 0;
  }
  // Of equal areas: all below the horizon to those up to 20/64 of the half-circle.
  const double top = std::sin((0.5 - 20.0 / 64) * M_PI);
  EXPECT_NEAR(num_low / 1000.0, 1 / (1 + top), 0.03);
}

TEST(ThinView, AnyFirstPartIsSpreadAsEvenly) {
  const std::vector<ThinnedView::Point> points = ThinView(Wall(), 1000);
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const ThinnedView::Point& point : points) mean += point.position / 1000;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  for (int i = 0; i < 100; ++i) first += points[i].position / 100;
  EXPECT_LT((first - mean).norm(), 0.1f);
}

TEST(LiveCloud, SendsEachViewOnce) {
  LiveCloud cloud;
  std::uint32_t end = 7;
  std::uint32_t max = 0;
  EXPECT_TRUE(Read(cloud.Bytes(0), &end, &max).empty());
  EXPECT_EQ(end, 0U);
  std::vector<int> seen;
  const auto get = [&] {
    for (const ReadView& view : Read(cloud.Bytes(end), &end, &max)) {
      EXPECT_EQ(view.x, static_cast<float>(view.frame));
      EXPECT_GT(view.num_points, 1000U);
      seen.push_back(view.frame);
    }
  };
  std::vector<int> added;
  for (int frame = 0; frame < 120; frame += 3) {
    Rigid3 pose;
    pose.translation.x() = frame;
    cloud.Add(frame, pose, Wall());
    added.push_back(frame);
    if (frame == 60) get();
  }
  EXPECT_LE(cloud.Bytes(0).size(), size_t{2} << 20) << "all at once would be too much";
  while (end < cloud.num_views()) get();
  EXPECT_EQ(seen, added);
  EXPECT_EQ(Read(cloud.Bytes(1000), &end, &max).size(), 0U);
}

TEST(LiveCloud, IsReadWhileViewsAreAdded) {
  LiveCloud cloud(100000);  // It is thinned twice.
  constexpr int kViews = 60;
  std::thread run([&cloud] {
    for (int frame = 0; frame < kViews; ++frame) cloud.Add(frame, Rigid3(), Wall());
  });
  std::vector<int> seen;
  std::uint32_t end = 0;
  std::uint32_t max = 0;
  while (end < kViews) {
    for (const ReadView& view : Read(cloud.Bytes(end), &end, &max)) {
      EXPECT_LE(view.num_points, 5000U);
      seen.push_back(view.frame);
    }
  }
  run.join();
  ASSERT_EQ(seen.size(), static_cast<size_t>(kViews));
  for (int frame = 0; frame < kViews; ++frame) EXPECT_EQ(seen[frame], frame);
}

TEST(LiveCloud, KeepsNoMorePointsThanAllowed) {
  LiveCloud cloud(20000);
  for (int frame = 0; frame < 100; ++frame) cloud.Add(frame, Rigid3(), Wall());
  size_t num_points = 0;
  std::uint32_t end = 0;
  std::uint32_t max = 0;
  while (end < cloud.num_views()) {
    for (const ReadView& view : Read(cloud.Bytes(end), &end, &max)) {
      EXPECT_LE(view.num_points, max);
      num_points += view.num_points;
    }
  }
  EXPECT_LE(num_points, 20000U);
  EXPECT_GT(num_points, 5000U);
}

}  // namespace
}  // namespace orb360
