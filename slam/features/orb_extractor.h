#pragma once

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/sphere_band.h"
#include "slam/features/sphere_pyramid.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/features/orb_options.h>

namespace orb360 {

/// ORB on the sphere: FAST corners on a pyramid that wraps at the seam, distributed by solid angle,
/// with orientation and descriptor sampled in the tangent plane (docs/concepts/features.md).
///
/// Rolling the image by k/32 of its width (which must be divisible by 32) gives exactly the same
/// features, shifted. One object serves one thread and keeps only memory between images.
class OrbExtractor {
 public:
  /// Throws ContractError for an option out of range.
  explicit OrbExtractor(const OrbOptions& options);

  /// `gray` is CV_8U and covers the whole sphere. `mask` is CV_8U of the same size, or empty;
  /// features whose centre has mask 0 are left out. Features are ordered by level, then row, then
  /// column. Runs on `num_threads` OpenMP threads; the result does not depend on how many.
  Features Extract(const cv::Mat& gray, const cv::Mat& mask = {}, int num_threads = 1);

  /// Returns the pyramid of the last image and gives up its ownership; empty before the first
  /// image.
  SpherePyramid TakePyramid() { return std::exchange(levels_, {}); }

 private:
  OrbOptions options_;
  SpherePyramid levels_;
  // Ordered by level, then band.
  std::vector<SphereBand> bands_;
  std::vector<SphereBand> blurred_;
  std::vector<cv::Mat> blurred_levels_;
};

}  // namespace orb360
