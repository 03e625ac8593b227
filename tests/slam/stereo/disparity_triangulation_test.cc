#include "slam/stereo/disparity_triangulation.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"

namespace orb360 {
namespace {

constexpr int kWidth = 61;  // no multiple of any vector
constexpr int kHeight = 40;
constexpr double kPixel = std::numbers::pi / kWidth;
constexpr double kLength = 0.7;

// The angle from the baseline at which a source view sees a point that the reference view sees at
// `angle`, `range` away.
double AngleAtSource(double angle, double range) {
  return std::atan2(range * std::sin(angle), range * std::cos(angle) - kLength);
}

// Each row is a sphere around the reference view.
double RangeOf(int row) { return 0.9 * std::pow(1.15, row); }

RefinedDisparities DisparitiesOfSpheres(double shift) {
  RefinedDisparities result{cv::Mat(kHeight, kWidth, CV_32F),
                            cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(0.3))};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double angle = (x + 0.5) * kPixel;
      result.disparity.at<float>(y, x) =
          static_cast<float>((AngleAtSource(angle, RangeOf(y)) - angle) / kPixel + shift);
    }
  }
  return result;
}

TEST(TriangulateDisparities, FindsThePointsOnEveryInstructionSet) {
  ForEachDispatchTarget([] {
    const InverseRanges found = TriangulateDisparities(DisparitiesOfSpheres(0), kLength, {});
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double angle = (x + 0.5) * kPixel;
        const double at_source = AngleAtSource(angle, RangeOf(y));
        if (std::min(std::sin(angle), std::sin(at_source)) < std::sin(0.1)) {
          EXPECT_EQ(found.value.at<float>(y, x), 0) << y << ' ' << x;
          EXPECT_EQ(found.sigma.at<float>(y, x), 0) << y << ' ' << x;
          continue;
        }
        EXPECT_NEAR(found.value.at<float>(y, x) * RangeOf(y), 1.0, 1e-4) << y << ' ' << x;
        ++count;
      }
    }
    EXPECT_GT(count, 2000);
  });
}

TEST(TriangulateDisparities, TheStandardDeviationIsWhatThatOfTheDisparityMakesOfTheInverseRange) {
  const DisparityTriangulationOptions options{.min_disparity_sigma = 0,
                                              .disparity_sigma_factor = 1};
  constexpr double kShift = 0.02;
  ForEachDispatchTarget([&] {
    const InverseRanges found = TriangulateDisparities(DisparitiesOfSpheres(0), kLength, options);
    const InverseRanges moved =
        TriangulateDisparities(DisparitiesOfSpheres(kShift), kLength, options);
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 10; x < kWidth - 10; ++x) {
        const float before = found.value.at<float>(y, x);
        const float after = moved.value.at<float>(y, x);
        if (!(before > 0 && after > 0)) continue;
        // 0.3 pixels, and fewer independent pixels in a window towards the baseline.
        const double spread = 0.3 / std::sqrt(std::sin((x + 0.5) * kPixel));
        EXPECT_NEAR(found.sigma.at<float>(y, x) * kShift / ((after - before) * spread), 1.0, 0.03);
        ++count;
      }
    }
    EXPECT_GT(count, 1000);
  });
}

TEST(TriangulateDisparities, UnknownDisparitiesHaveNoRange) {
  RefinedDisparities disparities = DisparitiesOfSpheres(0);
  disparities.disparity.setTo(-1);
  const InverseRanges found = TriangulateDisparities(disparities, kLength, {});
  EXPECT_EQ(cv::countNonZero(found.value), 0);
  EXPECT_EQ(cv::countNonZero(found.sigma), 0);
}

}  // namespace
}  // namespace orb360
