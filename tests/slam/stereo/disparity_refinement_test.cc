#include "slam/stereo/disparity_refinement.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "nn/base/statistics.h"
#include "tests/dispatch_targets.h"

namespace orb360 {
namespace {

constexpr int kWidth = 100;  // no multiple of any vector
constexpr int kHeight = 60;

double Disparity(double x) { return 6 + 0.1 * x; }

// Smooth texture without repetition.
double Texture(double x, double y) {
  return 120 + 40 * std::sin(0.7 * x + 0.3 * std::sin(0.9 * y)) + 30 * std::cos(0.41 * x + 0.8 * y);
}

struct Pair {
  cv::Mat first;
  cv::Mat second;  // brighter, shows column x at x + Disparity(x)
};

Pair MakePair(double noise) {
  Pair pair{cv::Mat(kHeight, kWidth, CV_8U), cv::Mat(kHeight, kWidth, CV_8U)};
  cv::RNG random(3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double from = (x - 6) / 1.1;
      pair.first.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(Texture(x, y) + random.gaussian(noise));
      pair.second.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(Texture(from, y) + 9 + random.gaussian(noise));
    }
  }
  return pair;
}

cv::Mat Rounded() {
  cv::Mat disparity(kHeight, kWidth, CV_32F);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      disparity.at<float>(y, x) = static_cast<float>(std::lround(Disparity(x)));
    }
  }
  return disparity;
}

TEST(RefineDisparities, FindsHundredthsOfAPixelUnderAnotherExposureOnEveryInstructionSet) {
  const Pair pair = MakePair(0);
  ForEachDispatchTarget([&] {
    const RefinedDisparities refined = RefineDisparities(pair.first, pair.second, Rounded(), {});
    std::vector<double> errors;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 4; x < 80; ++x) {
        ASSERT_GE(refined.disparity.at<float>(y, x), 0);
        errors.push_back(std::abs(refined.disparity.at<float>(y, x) - Disparity(x)));
      }
    }
    EXPECT_LT(Median(errors), 0.04);
    EXPECT_LT(NearestRankQuantile(errors, 0.95), 0.15);
  });
}

TEST(RefineDisparities, StatesTheErrorsThatNoiseMakes) {
  const Pair pair = MakePair(4);
  const RefinedDisparities refined =
      RefineDisparities(pair.first, pair.second, Rounded(), {.gray_sigma = 0.0});
  std::vector<double> in_sigmas;
  for (int y = 4; y < kHeight - 4; ++y) {
    for (int x = 4; x < 80; ++x) {
      in_sigmas.push_back(std::abs(refined.disparity.at<float>(y, x) - Disparity(x)) /
                          refined.sigma.at<float>(y, x));
    }
  }
  EXPECT_GT(NearestRankQuantile(in_sigmas, 0.68), 0.6);
  EXPECT_LT(NearestRankQuantile(in_sigmas, 0.68), 1.6);
}

TEST(RefineDisparities, UnknownNeighboursDoNotCount) {
  const Pair pair = MakePair(0);
  cv::Mat disparity(kHeight, kWidth, CV_32F, cv::Scalar(0));
  for (int x = 0; x < kWidth; x += 2) disparity.col(x).setTo(-1);
  // Of one image with itself; -1 is within a pixel of 0.
  const RefinedDisparities refined = RefineDisparities(pair.first, pair.first, disparity, {});
  for (int x = 5; x < kWidth - 5; x += 2) {
    EXPECT_EQ(cv::countNonZero(refined.disparity.col(x) != 0), 0) << x;
  }
}

TEST(RefineDisparities, KnowsNothingWhereNothingWasKnownOrNothingIsSeen) {
  Pair pair = MakePair(0);
  cv::Mat disparity = Rounded();
  disparity.rowRange(0, 20).setTo(-1);
  pair.first.colRange(30, 60).setTo(100);
  pair.second.colRange(30, 80).setTo(100);
  const RefinedDisparities refined = RefineDisparities(pair.first, pair.second, disparity, {});
  EXPECT_EQ(cv::countNonZero(refined.disparity.rowRange(0, 20) >= 0), 0);
  EXPECT_EQ(cv::countNonZero(refined.disparity(cv::Rect(36, 25, 18, 20)) >= 0), 0);
  EXPECT_GT(cv::countNonZero(refined.disparity(cv::Rect(4, 25, 20, 20)) >= 0), 390);
}

}  // namespace
}  // namespace orb360
