#include "slam/stereo/semi_global_matching.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kWidth = 256;
constexpr int kHeight = 512;
const SemiGlobalMatchingOptions kOptions;

SemiGlobalMatchingOptions Skipping(int num_levels) {
  SemiGlobalMatchingOptions options;
  options.num_skipped_levels = num_levels;
  return options;
}

const SemiGlobalMatchingOptions kAllLevels = Skipping(0);

// Texture without repetition, brighter than 40; rows wrap around.
cv::Mat Texture() {
  cv::Mat noise(kHeight, 2 * kWidth, CV_32F);
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, -400, 400);
  cv::Mat wrapped;
  cv::vconcat(std::vector<cv::Mat>{noise, noise, noise}, wrapped);
  cv::GaussianBlur(wrapped, wrapped, {0, 0}, 1.5);
  cv::Mat gray;
  wrapped.rowRange(kHeight, 2 * kHeight).convertTo(gray, CV_8U, 1, 128);
  return gray;
}

struct Pair {
  cv::Mat first;
  cv::Mat second;
};

// The second image shows column x of the first one at x + disparity(x, y).
Pair MakePair(const std::function<double(double, double)>& disparity) {
  const cv::Mat texture = Texture();
  cv::Mat map_x(kHeight, kWidth, CV_32F);
  cv::Mat map_y(kHeight, kWidth, CV_32F);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double from = x;  // x = from + disparity(from)
      for (int i = 0; i < 50; ++i) from = x - disparity(from, y);
      map_x.at<float>(y, x) = static_cast<float>(from + kWidth / 2);
      map_y.at<float>(y, x) = static_cast<float>(y);
    }
  }
  Pair pair{texture.colRange(kWidth / 2, kWidth / 2 + kWidth).clone(), {}};
  cv::remap(texture, pair.second, map_x, map_y, cv::INTER_LINEAR);
  return pair;
}

struct Accuracy {
  double known;         // fraction of the pixels whose partner is inside the second image
  double median_error;  // pixels
  double right;         // fraction of the known ones with an error below one pixel
};

Accuracy Compare(const cv::Mat& measured, const std::function<double(double, double)>& disparity) {
  std::vector<double> errors;
  int count = 0;
  int right = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 8; x < kWidth - 8; ++x) {
      const double truth = disparity(x, y);
      if (x + truth > kWidth - 8) continue;
      ++count;
      const float value = measured.at<float>(y, x);
      if (value < 0) continue;
      errors.push_back(std::abs(value - truth));
      right += errors.back() < 1;
    }
  }
  const auto known = static_cast<double>(errors.size());
  return {known / count, Median(errors), right / known};
}

TEST(MatchSemiGlobally, FindsDisparitiesOfASmoothSurfaceToAFractionOfAPixel) {
  const auto disparity = [](double x, double y) {
    return 25 + 12 * std::sin(0.02 * x) + 6 * std::cos(4 * std::numbers::pi * y / kHeight);
  };
  const Pair pair = MakePair(disparity);
  const Accuracy accuracy =
      Compare(MatchSemiGlobally(pair.first, pair.second, kOptions), disparity);
  EXPECT_GT(accuracy.known, 0.9);
  EXPECT_LT(accuracy.median_error, 0.2);
  EXPECT_GT(accuracy.right, 0.97);
}

TEST(MatchSemiGlobally, InterpolatesTheFinestLevelUnlessItIsSearched) {
  const auto disparity = [](double x, double y) {
    return 25 + 12 * std::sin(0.02 * x) + 6 * std::cos(4 * std::numbers::pi * y / kHeight);
  };
  const Pair pair = MakePair(disparity);
  const cv::Mat searched = MatchSemiGlobally(pair.first, pair.second, kAllLevels);
  const cv::Mat interpolated = MatchSemiGlobally(pair.first, pair.second, Skipping(1));
  EXPECT_LT(Compare(searched, disparity).median_error, 0.3);
  EXPECT_LT(Compare(interpolated, disparity).median_error, 0.3);
  EXPECT_GT(Compare(interpolated, disparity).known, Compare(searched, disparity).known - 0.05);
  // The coarsest level is always searched.
  EXPECT_GT(Compare(MatchSemiGlobally(pair.first, pair.second, Skipping(9)), disparity).known, 0.3);
  EXPECT_THROW(MatchSemiGlobally(pair.first, pair.second, Skipping(-1)), ContractError);
}

TEST(MatchSemiGlobally, FollowsTheGroundBelowTheCameraWhereDisparitiesChangeQuickly) {
  const auto disparity = [](double x, double) { return 4 + 0.4 * x; };
  const Pair pair = MakePair(disparity);
  const Accuracy accuracy =
      Compare(MatchSemiGlobally(pair.first, pair.second, kOptions), disparity);
  EXPECT_GT(accuracy.known, 0.7);
  EXPECT_GT(accuracy.right, 0.95);
}

TEST(MatchSemiGlobally, AddsTheSurfaceOfWhereTheWarpedImageWasMatched) {
  // The surface of the column itself would leave a median of 0.40 pixels on this slope.
  const auto disparity = [](double x, double y) {
    return 2 + 0.8 * x + 3 * std::sin(20 * std::numbers::pi * y / kHeight);
  };
  const Pair pair = MakePair(disparity);
  const Accuracy accuracy =
      Compare(MatchSemiGlobally(pair.first, pair.second, kAllLevels), disparity);
  EXPECT_LT(accuracy.median_error, 0.34);
  EXPECT_GT(accuracy.right, 0.97);
}

TEST(MatchSemiGlobally, KeepsTheEdgeBetweenTwoSurfaces) {
  const auto disparity = [](double, double y) { return y < kHeight / 2.0 ? 3.0 : 40.0; };
  const Pair pair = MakePair(disparity);
  const cv::Mat measured = MatchSemiGlobally(pair.first, pair.second, kAllLevels);
  for (const int from : {-6, 2}) {  // rows around the edge
    int right = 0;
    for (int y = kHeight / 2 + from; y < kHeight / 2 + from + 4; ++y) {
      for (int x = 8; x < kWidth - 48; ++x) {
        right += std::abs(measured.at<float>(y, x) - disparity(x, y)) < 1;
      }
    }
    EXPECT_GT(right, 0.75 * 4 * (kWidth - 56)) << from;
  }
}

TEST(MatchSemiGlobally, KnowsNothingWithoutTextureOrOfWhatOnlyOneViewShows) {
  const cv::Mat plain(kHeight, kWidth, CV_8U, cv::Scalar(100));
  EXPECT_EQ(cv::countNonZero(MatchSemiGlobally(plain, plain, kOptions) >= 0), 0);
  const Pair pair = MakePair([](double, double) { return 10.0; });
  cv::Mat covered = pair.second.clone();
  covered(cv::Rect(100, 100, 60, 60)) = 200;  // something else stands there
  const cv::Mat measured = MatchSemiGlobally(pair.first, covered, kOptions);
  EXPECT_LT(cv::countNonZero(measured(cv::Rect(95, 105, 50, 50)) >= 0), 0.1 * 50 * 50);
}

TEST(MatchSemiGlobally, KnowsNothingThatIsNotUniqueEnough) {
  const Pair pair = MakePair([](double, double) { return 10.0; });
  SemiGlobalMatchingOptions options;
  const int usual = cv::countNonZero(MatchSemiGlobally(pair.first, pair.second, options) >= 0);
  options.min_uniqueness = 1000;
  EXPECT_EQ(cv::countNonZero(MatchSemiGlobally(pair.first, pair.second, options) >= 0), 0);
  EXPECT_GT(usual, 0.8 * kHeight * kWidth);
}

TEST(MatchSemiGlobally, KnowsLittleOfNoise) {
  Pair noise{cv::Mat(kHeight, kWidth, CV_8U), cv::Mat(kHeight, kWidth, CV_8U)};
  cv::RNG random(9);
  random.fill(noise.first, cv::RNG::UNIFORM, 90, 110);
  random.fill(noise.second, cv::RNG::UNIFORM, 90, 110);
  EXPECT_LT(cv::countNonZero(MatchSemiGlobally(noise.first, noise.second, kOptions) >= 0),
            0.2 * kHeight * kWidth);
}

// Fine texture, of which a level of a quarter of the width sees nothing, with one disparity, and
// large blots on it, which it sees, with another one, as of a shadow or a reflection.
Pair MakeBlotted(const std::function<double(double, double)>& disparity,
                 const std::function<double(double, double)>& disparity_of_blots) {
  Pair pair = MakePair(disparity);
  Pair blots = MakePair(disparity_of_blots);
  const auto blur = [](const cv::Mat& image, double sigma) {
    cv::Mat blurred;
    image.convertTo(blurred, CV_32F);
    cv::GaussianBlur(blurred, blurred, {0, 0}, sigma);
    return blurred;
  };
  const auto join = [&](cv::Mat* image, const cv::Mat& blot) {
    cv::Mat fine;
    image->convertTo(fine, CV_32F);
    fine = 128 + (fine - blur(*image, 1.5)) + 3 * (blur(blot, 8) - 128);
    fine.convertTo(*image, CV_8U);
  };
  join(&pair.first, blots.first);
  join(&pair.second, blots.second);
  return pair;
}

cv::Mat HypothesisOf(const std::function<double(double, double)>& disparity) {
  cv::Mat hypothesis(kHeight / 2, kWidth / 2, CV_32F);
  for (int y = 0; y < hypothesis.rows; ++y) {
    for (int x = 0; x < hypothesis.cols; ++x) {
      hypothesis.at<float>(y, x) = static_cast<float>(disparity(2 * x + 0.5, 2 * y + 0.5) / 2);
    }
  }
  return hypothesis;
}

TEST(MatchSemiGlobally, FindsBesideAHypothesisWhatCoarserLevelsMiss) {
  const auto disparity = [](double x, double) { return 50 + 0.1 * x; };
  const Pair pair = MakeBlotted(disparity, [](double, double) { return 5.0; });
  const Accuracy without = Compare(MatchSemiGlobally(pair.first, pair.second, kOptions), disparity);
  // The hypothesis need not be exact.
  const cv::Mat hypothesis = HypothesisOf([&](double x, double y) { return disparity(x, y) + 3; });
  const Accuracy with =
      Compare(MatchSemiGlobally(pair.first, pair.second, kOptions, hypothesis), disparity);
  EXPECT_LT(without.right * without.known, 0.1);
  EXPECT_GT(with.right, 0.95);
  EXPECT_GT(with.known, 0.8);
}

TEST(MatchSemiGlobally, KeepsWhatItFoundWhereAHypothesisIsWrong) {
  const auto disparity = [](double x, double) { return 20 + 0.1 * x; };
  const Pair pair = MakePair(disparity);
  const cv::Mat hypothesis = HypothesisOf([](double, double y) { return y < 200 ? 90.0 : -1.0; });
  const cv::Mat without = MatchSemiGlobally(pair.first, pair.second, kOptions);
  const cv::Mat with = MatchSemiGlobally(pair.first, pair.second, kOptions, hypothesis);
  EXPECT_GT(Compare(with, disparity).known, Compare(without, disparity).known - 0.02);
  EXPECT_GT(Compare(with, disparity).right, 0.97);
  // Below it nothing changes.
  const cv::Mat unlike = (with != without).mul(cv::Mat((without >= 0) & (with >= 0)));
  EXPECT_EQ(cv::countNonZero(unlike.rowRange(240, kHeight)), 0);
}

TEST(MatchSemiGlobally, ChecksTheSizes) {
  const cv::Mat odd(192, 96, CV_8U, cv::Scalar(0));
  const cv::Mat small(64, 32, CV_8U, cv::Scalar(0));
  const cv::Mat image(256, 128, CV_8U, cv::Scalar(0));
  EXPECT_THROW(MatchSemiGlobally(odd, odd, kOptions), ContractError);
  EXPECT_THROW(MatchSemiGlobally(small, small, kOptions), ContractError);
  EXPECT_THROW(MatchSemiGlobally(image, image.rowRange(0, 64), kOptions), ContractError);
  const cv::Mat hypothesis(256, 128, CV_32F, cv::Scalar(1));
  EXPECT_EQ(SearchedWidth(128, kOptions), 64);
  EXPECT_THROW(MatchSemiGlobally(image, image, kOptions, hypothesis), ContractError);
}

}  // namespace
}  // namespace orb360
