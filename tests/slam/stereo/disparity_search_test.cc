#include "slam/stereo/disparity_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

cv::Mat Noise(int seed) {
  cv::Mat gray(kHeight, kWidth, CV_8U);
  cv::RNG(static_cast<uint64_t>(seed)).fill(gray, cv::RNG::UNIFORM, 0, 256);
  return gray;
}

CensusImage Transform(const cv::Mat& gray) {
  return TransformCensus(gray, cv::Mat::zeros(gray.size(), CV_8U));
}

// The image with its columns moved to the right by `shift`.
cv::Mat Shifted(const cv::Mat& gray, int shift) {
  cv::Mat shifted = Noise(99);
  const int count = kWidth - std::abs(shift);
  gray.colRange(std::max(0, -shift), std::max(0, -shift) + count)
      .copyTo(shifted.colRange(std::max(0, shift), std::max(0, shift) + count));
  return shifted;
}

// Semi-global matching as Hirschmueller's equations state it, in integers without vectors. Returns
// the sums over the four paths by pixel and hypothesis.
std::vector<std::vector<int>> ReferenceSums(const CensusImage& first, const CensusImage& second,
                                            int begin, int count,
                                            const DisparityPenalties& penalties) {
  std::vector<std::vector<int>> costs(kWidth * kHeight, std::vector<int>(count));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int i = 0; i < count; ++i) {
        const int other = x + begin + i;
        int bits = other < 0 || other >= kWidth ? kCensusBits : 0;
        for (int plane = 0; bits < kCensusBits && plane < CensusImage::kNumPlanes; ++plane) {
          bits +=
              std::popcount(static_cast<uint8_t>(first.planes[plane][first.StartOf(y) + x] ^
                                                 second.planes[plane][second.StartOf(y) + other]));
        }
        costs[y * kWidth + x][i] = bits;
      }
    }
  }
  std::vector<std::vector<int>> sums(costs.size(), std::vector<int>(count, 0));
  for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
    const int length = dx != 0 ? kWidth : kHeight;
    for (int line = 0; line < (dx != 0 ? kHeight : kWidth); ++line) {
      std::vector<int> path(count, 0);
      for (int step = dx != 0 ? 0 : -kPathLead; step < length; ++step) {
        const int at = (step + length) % length;
        const int along = dx + dy > 0 ? at : length - 1 - at;
        const int pixel = dx != 0 ? line * kWidth + along : along * kWidth + line;
        const int least = *std::ranges::min_element(path);
        std::vector<int> next(count);
        for (int i = 0; i < count; ++i) {
          int best = std::min(path[i], least + penalties.large);
          if (i > 0) best = std::min(best, path[i - 1] + penalties.small);
          if (i + 1 < count) best = std::min(best, path[i + 1] + penalties.small);
          next[i] = costs[pixel][i] + best - least;
          if (step >= 0) sums[pixel][i] += next[i];
        }
        path = next;
      }
    }
  }
  return sums;
}

TEST(SearchDisparities, HasTheLeastSumOfFourPathsOnEveryInstructionSet) {
  const CensusImage first = Transform(Noise(1));
  const CensusImage second = Transform(Shifted(Noise(1), 5));
  const DisparityPenalties penalties{4, 21};
  for (const DisparityRange range : {DisparityRange::kWide, DisparityRange::kAround}) {
    const int begin = range == DisparityRange::kWide ? 0 : -8;
    const int count = range == DisparityRange::kWide ? 32 : 16;
    const auto sums = ReferenceSums(first, second, begin, count, penalties);
    ForEachDispatchTarget([&] {
      const FoundDisparities found = SearchDisparities(first, second, range, penalties);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const std::vector<int>& sum = sums[y * kWidth + x];
          const auto best = static_cast<int>(std::ranges::min_element(sum) - sum.begin());
          double expected = begin + best;
          if (best > 0 && best + 1 < count && sum[best - 1] + sum[best + 1] > 2 * sum[best]) {
            expected += 0.5 * (sum[best - 1] - sum[best + 1]) /
                        (sum[best - 1] + sum[best + 1] - 2.0 * sum[best]);
          }
          int other = std::numeric_limits<int>::max();
          for (int i = 0; i < count; ++i) {
            if (std::abs(i - best) > 1) other = std::min(other, sum[i]);
          }
          ASSERT_NEAR(found.disparity.at<float>(y, x), expected, 1e-5) << x << ", " << y;
          ASSERT_NEAR(found.uniqueness.at<float>(y, x), (other + 1.0) / (sum[best] + 1), 1e-5);
        }
      }
    });
  }
}

TEST(SearchDisparities, FindsAShiftAndAgreesWithTheSecondImage) {
  const cv::Mat gray = Noise(2);
  for (const int shift : {-6, 0, 3}) {
    const FoundDisparities found = SearchDisparities(
        Transform(gray), Transform(Shifted(gray, shift)), DisparityRange::kAround, {});
    const cv::Mat inside = found.disparity.colRange(10, kWidth - 10);
    EXPECT_LT(cv::norm(inside - shift, cv::NORM_INF), 0.5) << shift;
    EXPECT_EQ(cv::countNonZero(found.difference.colRange(10, kWidth - 10)), 0);
    EXPECT_EQ(cv::countNonZero(found.cost.colRange(10, kWidth - 10)), 0);
  }
}

TEST(SearchDisparities, TellsHowFarBothImagesDisagree) {
  const cv::Mat gray = Noise(2);
  cv::Mat covered = Shifted(gray, 4);
  Noise(7).rowRange(10, 30).colRange(20, 40).copyTo(covered.rowRange(10, 30).colRange(20, 40));
  const FoundDisparities found =
      SearchDisparities(Transform(gray), Transform(covered), DisparityRange::kAround, {});
  EXPECT_GT(cv::mean(found.cost(cv::Rect(20, 14, 12, 12)))[0], 6);
  EXPECT_EQ(cv::countNonZero(found.difference.rowRange(35, 45).colRange(10, 50)), 0);
}

TEST(SearchDisparities, ChecksItsArguments) {
  const CensusImage census = Transform(Noise(1));
  const CensusImage other(kWidth, kHeight - 1);
  EXPECT_THROW(SearchDisparities(census, other, DisparityRange::kWide, {}), ContractError);
  EXPECT_THROW(SearchDisparities(census, census, DisparityRange::kWide, {6, 40}), ContractError);
  EXPECT_THROW(SearchDisparities(census, census, DisparityRange::kWide, {9, 8}), ContractError);
}

}  // namespace
}  // namespace orb360
