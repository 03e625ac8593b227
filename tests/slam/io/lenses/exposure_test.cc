#include "slam/io/lenses/exposure.h"

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(ExposureMatch, BothImagesMeetHalfWayAndSaturatedColoursDoNotCount) {
  ExposureMatch match;
  for (int i = 0; i < 1000; ++i) {
    const auto value = static_cast<uchar>(30 + i % 70);
    const auto twice = static_cast<uchar>(2 * value);
    match.Add({value, value, value}, {twice, twice, twice});
    match.Add({200, 200, 200}, {255, 255, 255});
  }
  const auto tables = match.Tables();
  cv::Vec3b dark(100, 50, 100);
  cv::Vec3b bright(200, 100, 200);
  ApplyTable(tables[0], &dark);
  ApplyTable(tables[1], &bright);
  EXPECT_NEAR(dark[0], 141, 1);  // 100 times the root of 2
  EXPECT_NEAR(bright[0], 141, 1);
  EXPECT_NEAR(dark[1], 71, 1);
  EXPECT_NEAR(bright[1], 71, 1);
}

TEST(ExposureMatch, AFewPairsChangeNothing) {
  ExposureMatch match;
  for (int i = 0; i < 10; ++i) match.Add({50, 50, 50}, {100, 100, 100});
  cv::Vec3b color(80, 90, 100);
  ApplyTable(match.Tables()[0], &color);
  EXPECT_EQ(color, cv::Vec3b(80, 90, 100));
}

}  // namespace
}  // namespace orb360
