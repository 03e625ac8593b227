#pragma once

#include "slam/stereo/disparity_refinement.h"
#include "slam/stereo/inverse_ranges.h"

namespace orb360 {

struct DisparityTriangulationOptions {
  /// Least angle between a bearing and the baseline, rad: towards the epipoles there is no
  /// parallax.
  double min_epipolar_angle = 0.1;
  /// Standard deviation of a disparity: this one, pixels, for what resampling does, and that of the
  /// refinement times this factor, because neighbouring pixels of a window are not independent.
  /// Both were measured with stereo_accuracy.
  double min_disparity_sigma = 0.15;
  double disparity_sigma_factor = 1.8;
};

/// Returns the inverse ranges of the pixels of a rectified sphere (RectifySphere), from the sine
/// rule in the triangle of both cameras, `length` apart, and the point.
InverseRanges TriangulateDisparities(const RefinedDisparities& disparities, double length,
                                     const DisparityTriangulationOptions& options);

}  // namespace orb360
