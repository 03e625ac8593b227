#pragma once

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/features.h"
#include "slam/features/sphere_band.h"
#include "slam/features/sphere_pyramid.h"

namespace orb360 {

struct OrbOptions {
  int num_features = 2000;
  int num_levels = 8;
  /// FAST score from which a pixel may be a feature (grey levels).
  int min_score = 8;
  /// Standard deviation of a feature's position, pixels of its own level.
  double pixel_sigma = 0.7;
};

/// ORB on the sphere: FAST corners on a pyramid that wraps at the seam, shared out by solid angle,
/// with orientation and descriptor sampled in the tangent plane.
///
/// Rolling the image by k/32 of its width (which must be divisible by 32) gives exactly the same
/// features, shifted. One object serves one thread, keeping nothing between images but memory.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);

  /// `gray`: CV_8U, the whole sphere. `mask`: CV_8U of the same size, or empty; features whose
  /// centre has mask 0 are left out. Features are ordered by level, then row, then column. Runs on
  /// `num_threads` OpenMP threads; the result does not depend on how many.
  Features Extract(const cv::Mat& gray, const cv::Mat& mask = {}, int num_threads = 1);

  /// The pyramid of the last image, which is then no longer here; empty before the first.
  SpherePyramid TakePyramid() { return std::exchange(levels_, {}); }

 private:
  OrbOptions options_;
  SpherePyramid levels_;
  // By level, then band.
  std::vector<SphereBand> bands_;
  std::vector<SphereBand> blurred_;
  std::vector<cv::Mat> blurred_levels_;
};

}  // namespace orb360
