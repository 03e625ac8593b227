#pragma once

namespace orb360 {

/// How landmarks become sparse depth (paper III-B).
struct SparseDepthOptions {
  /// Number of neighbouring keyframes whose landmarks are projected too.
  int num_neighbours = 20;
  /// A landmark that the keyframe has not observed is treated as hidden if, within this angle
  /// (radians), another landmark lies nearer than occlusion_ratio times its range.
  double occlusion_angle = 0.03;
  /// Ratio of the ranges of two landmarks in nearly the same direction below which the nearer one
  /// hides the farther one (occlusion_angle).
  double occlusion_ratio = 0.8;
  /// Least ratio of Landmark::found to Landmark::visible. Young landmarks that are found less often
  /// move, are hidden, or are wrong. In a finished map those have been culled, and the ratio tells
  /// little: a landmark is looked for long after the camera has passed it, when it is too small to
  /// be found.
  double min_found_fraction = 0;
  /// Standard deviation of the range, as a fraction of the range, at which the confidence is 1/2.
  double half_confidence_error = 0.1;
  /// Least confidence of a point. Points with less are mostly wrong landmarks, which the network
  /// trusts too much.
  double min_confidence = 0.5;
};

}  // namespace orb360
