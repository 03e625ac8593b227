#include "slam/evaluation/scale_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

// One window a second; the ratio of window i is exp(errors[i]).
LocalScale Windows(const std::vector<double>& errors) {
  LocalScale scale;
  for (size_t i = 0; i < errors.size(); ++i) {
    const auto time = static_cast<double>(i);
    scale.windows.push_back({.begin = 5 * time,
                             .ratio = std::exp(errors[i]),
                             .begin_time = time,
                             .end_time = time + 1});
  }
  return scale;
}

TEST(ScaleCalibration, CountsErrorsInStatedStandardDeviations) {
  const std::vector<StampedScale> stated = {
      {0.5, 1, 0.02}, {1.5, 1, 0.02}, {2.5, 1, 0.02}, {3.5, std::exp(0.1), 0.02}};
  const auto found = CalibrateScale(Windows({0.01, -0.03, 0.06, 0.1}), stated);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->windows, 4);
  EXPECT_NEAR(found->normalized_squared_error, (0.25 + 2.25 + 9.0 + 0.0) / 4, 1e-9);
  EXPECT_DOUBLE_EQ(found->within_1_sigma, 0.5);
  EXPECT_DOUBLE_EQ(found->within_2_sigma, 0.75);
  EXPECT_NEAR(found->largest, 3.0, 1e-9);
}

TEST(ScaleCalibration, TakesTheMeanInAWindowAndElseTheNearest) {
  const std::vector<StampedScale> stated = {
      {0.2, 1, 0.01}, {0.8, std::exp(0.04), 0.03}, {9.0, std::exp(0.02), 0.02}};
  const auto found = CalibrateScale(Windows({0.02, 0, 0, 0, 0, 0.04}), stated);
  ASSERT_TRUE(found);
  // Windows 1 to 4 lie nearer to the second time.
  EXPECT_NEAR(found->normalized_squared_error,
              (0.0 + 4 * std::pow(0.04 / 0.03, 2) + std::pow(0.02 / 0.02, 2)) / 6, 1e-9);
  EXPECT_FALSE(CalibrateScale(Windows({0.0}), {}));
}

}  // namespace
}  // namespace orb360
