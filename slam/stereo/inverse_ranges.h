#pragma once

#include <span>

#include <opencv2/core.hpp>

namespace orb360 {

/// What is seen of the range in each pixel, CV_32F: its inverse, 1 / world units, and the standard
/// deviation of that; 0 where unknown.
struct InverseRanges {
  cv::Mat value;
  cv::Mat sigma;
};

struct InverseRangeFusionOptions {
  /// Number of sources that must agree on a range, and the largest difference between two of them
  /// in standard deviations.
  int min_support = 2;
  double max_sigmas = 3.0;
  /// Largest standard deviation of ln(range). Farther points are unknown.
  double max_sigma = 0.054;
};

/// Joins measurements of the same pixels from several sources: the largest set that agrees,
/// weighted by variance. Where fewer than min_support agree the range is unknown. Contract: at
/// least one and at most kMaxStereoSources measurements, all of one size.
inline constexpr int kMaxStereoSources = 8;
InverseRanges FuseInverseRanges(std::span<const InverseRanges> measured,
                                const InverseRangeFusionOptions& options, int num_threads = 1);

}  // namespace orb360
