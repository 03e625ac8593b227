#pragma once

#include <optional>
#include <span>

#include "slam/io/lenses/lens_calibration.h"
#include "slam/io/lenses/overlap_matches.h"

namespace orb360 {

/// A calibration that was found from what both lenses show.
struct LensEstimate {
  LensCalibration calibration;
  int num_matches = 0;
  /// Median angle between the directions in which both lenses see the same thing, with the
  /// calibration at the start and with the result, radians.
  double median_before = 0.0;
  double median_after = 0.0;
};

/// Refines the rotation of the second lens and the centres and focal lengths of both, so that both
/// see matched things in the same direction. Things are taken to be far away. What the matches do
/// not show, as they lie near the rims of the lenses alone, stays close to the start: it has
/// standard deviations of 2 degrees, of half a hundredth of the image's size, and of one hundredth
/// of the focal length. Returns nullopt for fewer than 50 matches.
std::optional<LensEstimate> EstimateLenses(const LensCalibration& start,
                                           std::span<const LensMatch> matches);

/// Returns the ray in the lens frame, of unit length, that the lens shows at a pixel.
Eigen::Vector3d Unproject(const FisheyeLens& lens, const Eigen::Vector2d& pixel);

}  // namespace orb360
