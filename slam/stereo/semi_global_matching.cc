#include "slam/stereo/semi_global_matching.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "slam/stereo/census.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Numbers of hypotheses of a pixel on the coarsest level and on the others.
constexpr int kCoarseHypotheses = kCoarsestStereoWidth / 2;
constexpr int kFineHypotheses = 16;

// The hypotheses of one level: consecutive disparities from `first` on.
struct SearchRange {
  int width;
  int height;
  std::vector<int16_t> first;  // by pixel, row by row

  size_t IndexOf(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
};

// The disparity of each pixel, CV_32F; whether both views agree on it, CV_8U, 0 or 255; and its
// matching cost, CV_8U.
struct MatchedLevel {
  cv::Mat disparity;
  cv::Mat is_seen;
  cv::Mat cost;
};

// Hamming distances of the signatures, by pixel and hypothesis.
template <int kCount>
std::vector<uint8_t> MatchingCosts(const CensusImage& first, const CensusImage& second,
                                   const SearchRange& search, int num_threads) {
  std::vector<uint8_t> costs(search.first.size() * kCount);
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int y = 0; y < search.height; ++y) {
    const uint32_t* signatures1 = first.row(y);
    const uint32_t* signatures2 = second.row(y);
    for (int x = 0; x < search.width; ++x) {
      const size_t pixel = search.IndexOf(x, y);
      const int begin = x + search.first[pixel];
      for (int i = 0; i < kCount; ++i) {
        const bool is_inside = begin + i < search.width;
        costs[pixel * kCount + i] = static_cast<uint8_t>(
            is_inside ? std::popcount(signatures1[x] ^ signatures2[begin + i]) : kCensusBits);
      }
    }
  }
  return costs;
}

// The aggregated costs of the pixel that a path has reached.
template <int kCount>
struct PathCosts {
  // A hypothesis more at each end, which is never the best one.
  static constexpr uint16_t kFar = 0x3fff;
  std::array<uint16_t, kCount + 2> costs{kFar};
  uint16_t least = 0;

  PathCosts() { costs.back() = kFar; }

  // Goes on to the next pixel and adds its aggregated costs to `sums`.
  void Advance(const uint8_t* matching, const SemiGlobalMatchingOptions& options, uint16_t* sums) {
    std::array<uint16_t, kCount> next;
    for (int i = 0; i < kCount; ++i) {
      const int beside = std::min(costs[i], costs[i + 2]) + options.small_penalty;
      const int best = std::min(std::min<int>(costs[i + 1], beside), least + options.large_penalty);
      next[i] = static_cast<uint16_t>(matching[i] + best - least);
    }
    for (int i = 0; i < kCount; ++i) sums[i] = static_cast<uint16_t>(sums[i] + next[i]);
    std::ranges::copy(next, costs.begin() + 1);
    least = *std::ranges::min_element(next);
  }
};

// Sums of the costs along four paths: to the right, to the left, down and up.
template <int kCount>
std::vector<uint16_t> AggregateCosts(const std::vector<uint8_t>& matching,
                                     const SearchRange& search,
                                     const SemiGlobalMatchingOptions& options, int num_threads) {
  std::vector<uint16_t> sums(matching.size(), 0);
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int y = 0; y < search.height; ++y) {
    PathCosts<kCount> right;
    PathCosts<kCount> left;
    for (int i = 0; i < search.width; ++i) {
      const size_t ahead = search.IndexOf(i, y) * kCount;
      const size_t back = search.IndexOf(search.width - 1 - i, y) * kCount;
      right.Advance(&matching[ahead], options, &sums[ahead]);
      left.Advance(&matching[back], options, &sums[back]);
    }
  }
  // Columns are closed. A path begins so far ahead that its beginning does not matter.
  constexpr int kAhead = 32;  // rows
  constexpr int kBlock = 16;  // columns
  ORB360_CHECK(search.width % kBlock == 0 && search.height >= kAhead, search.width, search.height);
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int block = 0; block < search.width; block += kBlock) {
    std::array<uint16_t, kCount> unused{};
    for (const bool is_down : {true, false}) {
      std::array<PathCosts<kCount>, kBlock> paths;
      for (int i = -kAhead; i < search.height; ++i) {
        const int along = (i + search.height) % search.height;
        const int y = is_down ? along : search.height - 1 - along;
        for (int x = 0; x < kBlock; ++x) {
          const size_t pixel = search.IndexOf(block + x, y) * kCount;
          paths[x].Advance(&matching[pixel], options, i < 0 ? unused.data() : &sums[pixel]);
        }
      }
    }
  }
  return sums;
}

// The disparity of each pixel of the second view in one row, or -1, from the sums of the first one.
template <int kCount>
std::vector<int> DisparitiesOfSecond(const uint16_t* sums, const int16_t* first, int width) {
  std::vector<uint16_t> least(width, std::numeric_limits<uint16_t>::max());
  std::vector<int> disparities(width, -1);
  for (int x = 0; x < width; ++x) {
    for (int i = 0; i < kCount && x + first[x] + i < width; ++i) {
      const uint16_t sum = sums[x * kCount + i];
      if (sum >= least[x + first[x] + i]) continue;
      least[x + first[x] + i] = sum;
      disparities[x + first[x] + i] = first[x] + i;
    }
  }
  return disparities;
}

// The place of the minimum of a parabola through three sums, relative to the middle one.
double ParabolaMinimum(double before, double at, double after) {
  const double curvature = before - 2 * at + after;
  return curvature > 0 ? 0.5 * (before - after) / curvature : 0.0;
}

template <int kCount>
MatchedLevel SelectDisparities(const std::vector<uint8_t>& matching,
                               const std::vector<uint16_t>& sums, const SearchRange& search,
                               const SemiGlobalMatchingOptions& options, int num_threads) {
  const cv::Size size(search.width, search.height);
  MatchedLevel level{cv::Mat(size, CV_32F), cv::Mat(size, CV_8U), cv::Mat(size, CV_8U)};
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (int y = 0; y < search.height; ++y) {
    const uint16_t* row = &sums[search.IndexOf(0, y) * kCount];
    const int16_t* first = &search.first[search.IndexOf(0, y)];
    const std::vector<int> of_second = DisparitiesOfSecond<kCount>(row, first, search.width);
    for (int x = 0; x < search.width; ++x) {
      const uint16_t* sum = row + x * kCount;
      const auto best = static_cast<int>(std::min_element(sum, sum + kCount) - sum);
      uint16_t second = std::numeric_limits<uint16_t>::max();
      for (int i = 0; i < kCount; ++i) {
        if (std::abs(i - best) > 1) second = std::min(second, sum[i]);
      }
      const int disparity = first[x] + best;
      const bool is_inner = best > 0 && best + 1 < kCount;
      const double refinement =
          is_inner ? ParabolaMinimum(sum[best - 1], sum[best], sum[best + 1]) : 0.0;
      level.disparity.at<float>(y, x) = static_cast<float>(std::max(0.0, disparity + refinement));
      const bool is_seen =
          x + disparity < search.width &&
          std::abs(of_second[x + disparity] - disparity) <= options.max_difference &&
          second + 1 >= options.min_uniqueness * (sum[best] + 1);
      level.is_seen.at<uint8_t>(y, x) = is_seen ? 255 : 0;
      level.cost.at<uint8_t>(y, x) = matching[search.IndexOf(x, y) * kCount + best];
    }
  }
  return level;
}

template <int kCount>
MatchedLevel MatchLevel(const cv::Mat& first, const cv::Mat& second, const SearchRange& search,
                        const SemiGlobalMatchingOptions& options, int num_threads) {
  const std::vector<uint8_t> matching =
      MatchingCosts<kCount>(TransformCensus(first, num_threads),
                            TransformCensus(second, num_threads), search, num_threads);
  const std::vector<uint16_t> sums = AggregateCosts<kCount>(matching, search, options, num_threads);
  return SelectDisparities<kCount>(matching, sums, search, options, num_threads);
}

// The hypotheses around the disparities of the level above, whose size is half of `size`.
SearchRange SearchAround(const cv::Mat& above, const cv::Size& size) {
  constexpr int kMedian = 5;  // pixels
  cv::Mat median;
  cv::medianBlur(above, median, kMedian);
  cv::Mat surface;
  cv::resize(median, surface, size, 0, 0, cv::INTER_LINEAR);
  SearchRange search{size.width, size.height, {}};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto expected = static_cast<int>(std::lround(2 * surface.at<float>(y, x)));
      search.first.push_back(static_cast<int16_t>(std::max(0, expected - kFineHypotheses / 2)));
    }
  }
  return search;
}

// Where the image has texture along its rows and the costs are low, CV_8U, 0 or 255.
cv::Mat IsReliable(const cv::Mat& image, const cv::Mat& cost,
                   const SemiGlobalMatchingOptions& options) {
  const cv::Size window(5, 5);
  cv::Mat mean_cost;
  cv::boxFilter(cost, mean_cost, CV_32F, window);
  cv::Mat derivative;
  cv::filter2D(image, derivative, CV_32F, cv::Mat_<float>({1, 3}, {-1, 0, 1}));
  cv::Mat mean_gradient;
  cv::boxFilter(cv::abs(derivative), mean_gradient, CV_32F, window);
  return (mean_cost <= options.max_cost) & (mean_gradient >= options.min_gradient);
}

}  // namespace

cv::Mat MatchSemiGlobally(const cv::Mat& first, const cv::Mat& second,
                          const SemiGlobalMatchingOptions& options, int num_threads) {
  ORB360_CHECK(options.num_levels > 0 &&
                   first.cols == kCoarsestStereoWidth << (options.num_levels - 1) &&
                   first.size() == second.size(),
               first.cols, options.num_levels);
  std::vector<std::array<cv::Mat, 2>> pyramid = {{first, second}};
  while (static_cast<int>(pyramid.size()) < options.num_levels) {
    std::array<cv::Mat, 2> half;
    for (int i = 0; i < 2; ++i) {
      cv::resize(pyramid.back()[i], half[i], {}, 0.5, 0.5, cv::INTER_AREA);
    }
    pyramid.push_back(half);
  }
  const cv::Size coarsest = pyramid.back()[0].size();
  const SearchRange whole{coarsest.width, coarsest.height,
                          std::vector<int16_t>(static_cast<size_t>(coarsest.area()), 0)};
  MatchedLevel level = MatchLevel<kCoarseHypotheses>(pyramid.back()[0], pyramid.back()[1], whole,
                                                     options, num_threads);
  for (pyramid.pop_back(); !pyramid.empty(); pyramid.pop_back()) {
    const auto& [image1, image2] = pyramid.back();
    level = MatchLevel<kFineHypotheses>(
        image1, image2, SearchAround(level.disparity, image1.size()), options, num_threads);
  }
  level.disparity.setTo(-1.0f, ~(level.is_seen & IsReliable(first, level.cost, options)));
  return level.disparity;
}

}  // namespace orb360
