#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/depth_view.h"

namespace orb360 {

struct ConfirmationOptions {
  /// Other keyframes that must see a point where it is.
  int min_support = 2;
  /// A point is refused when more than this share of the keyframes with an opinion see through it.
  double max_conflict_share = 0.34;
  /// Two ranges agree up to so many expected errors ...
  double tolerance_errors = 2.5;
  /// ... and this share of the range more: for poses, sampling, and what confidence does not know.
  double tolerance_share = 0.01;
  /// The least expected error of ln(range), however confident the network is.
  double min_error = 0.01;
  /// A point is left to a keyframe that sees it too and has so many times less variance.
  double redundant_ratio = 4.0;
  /// Keyframes of the same place err alike: together they are at most so many times as certain as
  /// the best of them (in variance).
  double max_independent = 4.0;
};

/// A point of a keyframe that others have confirmed.
struct ConfirmedPoint {
  Eigen::Vector3d position;  // world
  Eigen::Vector3f normal;    // world, unit, towards the camera
  float error;               // along the normal, to be expected, world units
  int row;                   // its pixel
  int column;
};

/// Which pixels of a keyframe are tried.
struct SamplingOptions {
  /// World units: where pixels are closer to each other than half of this, every other one, every
  /// fourth one ... is taken; and towards the poles, fewer of each row, so that every direction has
  /// as many.
  double spacing = 0.05;
  /// World units; what is farther away is left out.
  double max_range = 30.0;
  /// World units; as are points whose expected error is larger.
  double max_error = 0.2;
};

/// The points of a keyframe that the others agree with. A point is compared with what each of them
/// sees in its direction: the same surface supports it, something nearer hides it, and something
/// farther away, here and in the pixels around, contradicts it: the keyframe looks through it. What
/// moves and what the network invents meets contradiction, or no support. Where keyframes agree,
/// the point moves along its normal to the mean of all, weighted by certainty.
///
/// Ordered by row, then column: the same for any number of OpenMP threads.
std::vector<ConfirmedPoint> ConfirmSurface(const DepthView& view,
                                           std::span<const DepthView* const> others,
                                           const ConfirmationOptions& options,
                                           const SamplingOptions& sampling, int num_threads = 1);

}  // namespace orb360
