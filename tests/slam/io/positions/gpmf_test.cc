#include "slam/io/positions/gpmf.h"

#include <gtest/gtest.h>

#include "slam/io/positions/utc_time.h"
#include "tests/slam/io/positions/gpmf_writer.h"

namespace orb360 {
namespace {

TEST(Gpmf, GivesEachMeasurementItsNumbersAndItsFractionOfTheSample) {
  const GpmfPositions positions = ParseGpmf(
      WriteGps5({{47.5, 8.25, 400.5, 2.0}, {47.50001, 8.2501, 401.25, 2.0}}, "240229235959.750"));
  ASSERT_EQ(positions.fixes.size(), 2U);
  EXPECT_DOUBLE_EQ(positions.fixes[1].latitude, 47.50001);
  EXPECT_DOUBLE_EQ(positions.fixes[1].longitude, 8.2501);
  EXPECT_DOUBLE_EQ(*positions.fixes[1].altitude, 401.25);
  EXPECT_DOUBLE_EQ(positions.fixes[1].timestamp, 0.5);
  EXPECT_DOUBLE_EQ(*positions.fixes[0].horizontal_sigma, 2.0 * kMetresPerDop);
  EXPECT_EQ(positions.altitude_reference, AltitudeReference::kMeanSeaLevel);
  EXPECT_DOUBLE_EQ(*positions.utc, *ParseIsoTime("2024-02-29T23:59:59.75Z"));
}

TEST(Gpmf, TakesLockPrecisionAndTimeOfEachMeasurementFromGps9) {
  std::vector<GpmfMeasurement> measurements(4, {47.5, 8.25, 400.5});
  measurements[0].fix = 0;
  measurements[1].fix = 2;
  measurements[2].dop = 4.25;
  for (int i = 0; i < 4; ++i) {
    measurements[i].utc_days = 9190;  // 2025-02-28
    measurements[i].utc_seconds = 3600 + 0.1 * i;
  }
  const GpmfPositions positions = ParseGpmf(WriteGps9(measurements));
  EXPECT_EQ(positions.num_without_lock, 1);
  ASSERT_EQ(positions.fixes.size(), 3U);
  EXPECT_FALSE(positions.fixes[0].altitude);  // In two dimensions none is measured.
  EXPECT_TRUE(positions.fixes[1].altitude);
  EXPECT_DOUBLE_EQ(*positions.fixes[1].horizontal_sigma, 4.25 * kMetresPerDop);
  EXPECT_NEAR(*positions.utc, *ParseIsoTime("2025-02-28T01:00:00.1Z"), 1e-6);
}

TEST(Gpmf, PrefersGps9WhereACameraWritesBoth) {
  const std::string both = WriteGps5({{1, 2, 3}}, "240101000000.000") +
                           WriteGps9({{47.5, 8.25, 400.5}}) +
                           WriteGps5({{4, 5, 6}}, "240101000000.000");
  const GpmfPositions positions = ParseGpmf(both);
  ASSERT_EQ(positions.fixes.size(), 1U);
  EXPECT_DOUBLE_EQ(positions.fixes[0].latitude, 47.5);
}

TEST(Gpmf, AnyBeginningOfASampleIsRead) {
  const std::string whole = WriteGps5({{47.5, 8.25, 400.5}, {47.6, 8.3, 401}}, "240229235959.750");
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(ParseGpmf(std::string(whole.substr(0, size))).fixes.empty()) << size;
  }
}

TEST(Gpmf, LeavesOutScalesOfZeroAndPlacesThatAreNotOnEarth) {
  std::string zero = WriteGps5({{47.5, 8.25, 400.5}}, "240229235959.750");
  zero.replace(zero.find("SCAL") + 8, 4, 4, '\0');
  EXPECT_TRUE(ParseGpmf(zero).fixes.empty());
  EXPECT_TRUE(ParseGpmf(WriteGps5({{97.5, 8.25, 400.5}}, "240229235959.750")).fixes.empty());
  EXPECT_TRUE(ParseGpmf(WriteGps5({{0, 0, 0}}, "240229235959.750")).fixes.empty());
}

}  // namespace
}  // namespace orb360
