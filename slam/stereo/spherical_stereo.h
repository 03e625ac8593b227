#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "slam/stereo/semi_global_matching.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// An image of the whole sphere (CV_8U, twice as wide as high) and where it was taken.
struct StereoView {
  cv::Mat gray;
  Rigid3 world_from_camera;
};

struct SphericalStereoOptions {
  SemiGlobalMatchingOptions matching;
  /// Least angle between a bearing and the baseline, rad: towards the epipoles there is no
  /// parallax.
  double min_epipolar_angle = 0.1;
  /// Standard deviation of a disparity, pixels.
  double disparity_sigma = 0.5;
  /// Number of sources that must agree on a range, and the largest difference between two of them
  /// in standard deviations.
  int min_support = 2;
  double max_sigmas = 3.0;
  /// Largest standard deviation of ln(range). Farther points are unknown.
  double max_sigma = 0.1;
};

/// What is seen of the range in each pixel, CV_32F: its inverse, 1 / world units, and the standard
/// deviation of that; 0 where unknown.
struct InverseRanges {
  cv::Mat value;
  cv::Mat sigma;
};

/// Measures the inverse ranges of `reference` from another view. Throws ContractError unless both
/// are as large, their width is
/// 2^(num_levels + 6), and they were taken from different places.
InverseRanges MatchSphere(const StereoView& reference, const StereoView& source,
                          const SphericalStereoOptions& options, int num_threads = 1);

/// Joins measurements of the same pixels from several sources: the largest set that agrees,
/// weighted by variance. Where fewer than min_support agree the range is unknown.
InverseRanges FuseInverseRanges(std::span<const InverseRanges> measured,
                                const SphericalStereoOptions& options);

}  // namespace orb360
