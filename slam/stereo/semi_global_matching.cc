#include "slam/stereo/semi_global_matching.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "slam/stereo/census.h"
#include "slam/stereo/row_warp.h"
#include "slam/stereo/speckles.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// The disparities of one level. `surface`: those expected, CV_32F, empty on the coarsest level.
// found.disparity is relative to the surface; `disparity` is the sum.
struct MatchedLevel {
  FoundDisparities found;
  cv::Mat disparity;
};

MatchedLevel MatchLevel(const cv::Mat& first, const cv::Mat& second, const cv::Mat& surface,
                        const SemiGlobalMatchingOptions& options) {
  const cv::Mat inside = cv::Mat::zeros(first.size(), CV_8U);
  const CensusImage census = TransformCensus(first, inside);
  if (surface.empty()) {
    FoundDisparities found = SearchDisparities(census, TransformCensus(second, inside),
                                               DisparityRange::kWide, options.penalties);
    cv::Mat disparity = found.disparity;
    return {std::move(found), std::move(disparity)};
  }
  const WarpedRows warped = WarpRows(second, surface);
  cv::Mat expected;
  warped.image.convertTo(expected, CV_8U);
  FoundDisparities found = SearchDisparities(census, TransformCensus(expected, warped.is_outside),
                                             DisparityRange::kAround, options.penalties);
  // What lies at column x + d of the warped image lies at x + d + surface(x + d) of the second one.
  cv::Mat disparity = cv::max(found.disparity + WarpRows(surface, found.disparity).image, 0.0);
  return {std::move(found), std::move(disparity)};
}

// What is expected on a level of this size from the disparities of the level above.
cv::Mat ExpectedSurface(const cv::Mat& above, const cv::Size& size) {
  constexpr int kMedian = 5;  // pixels
  cv::Mat median;
  cv::medianBlur(above, median, kMedian);
  cv::Mat surface;
  cv::resize(median, surface, size, 0, 0, cv::INTER_LINEAR);
  return 2 * surface;
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

// Takes the disparities that are found around a hypothesis where they cost less.
void TryHypothesis(const cv::Mat& first, const cv::Mat& second, const cv::Mat& hypothesis,
                   const SemiGlobalMatchingOptions& options, MatchedLevel* level) {
  // The bits of one signature are few, and a window much larger would reach over edges.
  const cv::Size window(9, 9);
  const cv::Mat is_given = hypothesis >= 0;
  cv::Mat surface = level->disparity.clone();
  hypothesis.copyTo(surface, is_given);
  const MatchedLevel other = MatchLevel(first, second, surface, options);
  cv::Mat cost;
  cv::Mat other_cost;
  cv::boxFilter(level->found.cost, cost, CV_32F, window);
  cv::boxFilter(other.found.cost, other_cost, CV_32F, window);
  const cv::Mat is_better = is_given & (other_cost < cost);
  other.disparity.copyTo(level->disparity, is_better);
  other.found.cost.copyTo(level->found.cost, is_better);
  other.found.uniqueness.copyTo(level->found.uniqueness, is_better);
  other.found.difference.copyTo(level->found.difference, is_better);
}

// The disparities of a finer level, known where all that are interpolated are known.
cv::Mat Interpolate(const cv::Mat& coarse, const cv::Size& size) {
  const double ratio = static_cast<double>(size.width) / coarse.cols;
  cv::Mat is_unknown;
  cv::resize(coarse < 0, is_unknown, size, 0, 0, cv::INTER_LINEAR);
  cv::Mat disparity;
  cv::resize(coarse, disparity, size, 0, 0, cv::INTER_LINEAR);
  disparity = ratio * disparity;
  disparity.setTo(-1.0f, is_unknown > 0);
  return disparity;
}

}  // namespace

cv::Mat MatchSemiGlobally(const cv::Mat& first, const cv::Mat& second,
                          const SemiGlobalMatchingOptions& options, const cv::Mat& hypothesis) {
  ORB360_CHECK(options.num_skipped_levels >= 0, options.num_skipped_levels);
  ORB360_CHECK(first.cols >= kCoarsestStereoWidth && first.cols % kCoarsestStereoWidth == 0 &&
                   std::has_single_bit(static_cast<unsigned>(first.cols)) &&
                   first.size() == second.size(),
               first.size(), second.size());
  std::vector<std::array<cv::Mat, 2>> pyramid = {{first, second}};
  while (pyramid.back()[0].cols > kCoarsestStereoWidth) {
    std::array<cv::Mat, 2> half;
    for (int i = 0; i < 2; ++i) {
      cv::resize(pyramid.back()[i], half[i], {}, 0.5, 0.5, cv::INTER_AREA);
    }
    pyramid.push_back(half);
  }
  // The coarsest level is always searched.
  const auto finest = std::min(static_cast<size_t>(options.num_skipped_levels), pyramid.size() - 1);
  MatchedLevel level = MatchLevel(pyramid.back()[0], pyramid.back()[1], {}, options);
  for (size_t i = pyramid.size() - 1; i-- > finest;) {
    const auto& [image1, image2] = pyramid[i];
    level = MatchLevel(image1, image2, ExpectedSurface(level.disparity, image1.size()), options);
  }
  if (!hypothesis.empty()) {
    const auto& [image1, image2] = pyramid[finest];
    ORB360_CHECK(hypothesis.size() == image1.size(), hypothesis.size(), image1.size());
    TryHypothesis(image1, image2, hypothesis, options, &level);
  }
  const cv::Mat is_seen = (level.found.difference <= options.max_difference) &
                          (level.found.uniqueness >= options.min_uniqueness);
  level.disparity.setTo(-1.0f,
                        ~(is_seen & IsReliable(pyramid[finest][0], level.found.cost, options)));
  RemoveSpeckles(options.speckles, &level.disparity);
  return finest == 0 ? level.disparity : Interpolate(level.disparity, first.size());
}

int SearchedWidth(int width, const SemiGlobalMatchingOptions& options) {
  return std::max(width >> options.num_skipped_levels, kCoarsestStereoWidth);
}

}  // namespace orb360
