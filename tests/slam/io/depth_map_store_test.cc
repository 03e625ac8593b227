#include "slam/io/depth_map_store.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

DenseDepth Example(int width, int height) {
  const cv::Size size(width, height);
  DenseDepth depth{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F), cv::Mat(size, CV_8UC3),
                   cv::Mat(size, CV_8UC1)};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double fraction = (row * width + column) / static_cast<double>(width * height);
      // All scales that maps could have.
      depth.range.at<float>(row, column) = static_cast<float>(std::exp(60.0 * fraction - 30.0));
      depth.confidence.at<float>(row, column) = static_cast<float>(1.0 - fraction);
      depth.source.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((row + column) % 5);
      depth.color.at<cv::Vec3b>(row, column) =
          cv::Vec3b(static_cast<uchar>(column), static_cast<uchar>(row), 100);
    }
  }
  return depth;
}

TEST(DepthMapStore, GivesBackWithinTheErrorsItPromises) {
  const TempFolder folder;
  const DepthMapStore store(folder / "store");
  const DenseDepth depth = Example(128, 64);
  store.Put(7, depth);
  const DenseDepth read = store.Get(7);
  ASSERT_EQ(read.range.size(), depth.range.size());
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 128; ++column) {
      const double range = depth.range.at<float>(row, column);
      ASSERT_NEAR(read.range.at<float>(row, column) / range, 1.0, 5e-4);
      ASSERT_GT(read.confidence.at<float>(row, column), 0.0f);
      ASSERT_NEAR(read.confidence.at<float>(row, column), depth.confidence.at<float>(row, column),
                  1.01 / 255);
    }
  }
  EXPECT_EQ(cv::norm(read.source, depth.source, cv::NORM_INF), 0);
  EXPECT_LT(cv::norm(read.color, depth.color, cv::NORM_INF), 20);
  DenseDepth without = Example(128, 64);
  without.source.release();
  store.Put(8, without);
  EXPECT_EQ(cv::countNonZero(store.Get(8).source), 0);
}

TEST(DepthMapStore, WhatIsNoRangeIsNone) {
  const TempFolder folder;
  const DepthMapStore store(folder / "store");
  DenseDepth depth = Example(16, 8);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int column = 0; column < 4; ++column) {
    const float none[] = {0.0f, -1.0f, kNan, kInfinity};
    depth.range.at<float>(3, column) = none[column];
    depth.confidence.at<float>(4, column) = none[column];
  }
  store.Put(0, depth);
  const DenseDepth read = store.Get(0);
  for (int row : {3, 4}) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_EQ(read.range.at<float>(row, column), 0.0f) << row << ' ' << column;
      EXPECT_EQ(read.confidence.at<float>(row, column), 0.0f);
      EXPECT_EQ(read.source.at<std::uint8_t>(row, column), 0);
    }
  }
  EXPECT_EQ(cv::countNonZero(read.range), 16 * 8 - 8);
}

TEST(DepthMapStore, ReplacesAndTellsWhatItHas) {
  const TempFolder folder;
  const DepthMapStore store(folder / "store");
  EXPECT_FALSE(store.Contains(3));
  store.Put(3, Example(16, 8));
  store.Put(3, Example(32, 16));
  EXPECT_TRUE(store.Contains(3));
  EXPECT_EQ(store.Get(3).range.cols, 32);
}

TEST(DepthMapStore, LeavesNothingBehindAndTakesNothingOver) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "store");
  WriteText(folder / "store/5", "of a run that was killed");
  {
    const DepthMapStore store(folder / "store");
    EXPECT_FALSE(store.Contains(5));
    store.Put(1, Example(16, 8));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "store"));
}

TEST(DepthMapStore, SaysWhatIsDamaged) {
  const TempFolder folder;
  const DepthMapStore store(folder / "store");
  store.Put(1, Example(64, 32));
  const std::string whole = ReadText(folder / "store/1");
  for (const double fraction : {0.0, 0.001, 0.3, 0.99}) {
    WriteText(folder / "store/1",
              whole.substr(0, static_cast<size_t>(fraction * static_cast<double>(whole.size()))));
    EXPECT_THAT(MessageOf<UserError>([&] { store.Get(1); }), testing::HasSubstr("damaged"));
  }
  std::uint32_t packed = 0;  // bytes of ranges and confidences, behind a header of 16
  std::memcpy(&packed, whole.data() + 8, sizeof packed);
  ASSERT_GT(packed, 50u);
  WriteText(folder / "store/1", whole);
  const DenseDepth read = store.Get(1);
  size_t noticed = 0;
  for (size_t place = 16 + 6; place < 16 + packed; ++place) {  // behind zstd's own header
    std::string changed = whole;
    changed[place] = static_cast<char>(changed[place] ^ 4);
    WriteText(folder / "store/1", changed);
    try {
      // A bit may be one of those that fill up a byte.
      EXPECT_EQ(cv::norm(store.Get(1).range, read.range, cv::NORM_INF), 0) << place;
    } catch (const UserError&) {
      ++noticed;
    }
  }
  EXPECT_GT(noticed, (packed - 6) * 9 / 10);
  EXPECT_THAT(MessageOf<UserError>([&] { store.Get(2); }), testing::HasSubstr("gone"));
  WriteText(folder / "file", "");
  EXPECT_THAT(MessageOf<UserError>([&] { DepthMapStore(folder / "file/store"); }),
              testing::HasSubstr("cannot be written"));
}

TEST(DepthMapStore, RefusesImagesThatDoNotBelongTogether) {
  const TempFolder folder;
  const DepthMapStore store(folder / "store");
  DenseDepth depth = Example(16, 8);
  depth.color = depth.color.rowRange(0, 4);
  EXPECT_THROW(store.Put(0, depth), ContractError);
  depth = Example(16, 8);
  depth.source = depth.source.rowRange(0, 4);
  EXPECT_THROW(store.Put(0, depth), ContractError);
}

}  // namespace
}  // namespace orb360
