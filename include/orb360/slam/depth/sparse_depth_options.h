#pragma once

namespace orb360 {

struct SparseDepthOptions {
  /// Number of neighbouring keyframes whose landmarks are projected too.
  int num_neighbours = 20;
  /// A landmark that the keyframe has not observed is treated as hidden if, within this angle
  /// (radians), another landmark lies nearer than occlusion_ratio times its range.
  double occlusion_angle = 0.03;
  /// See occlusion_angle.
  double occlusion_ratio = 0.8;
  /// Landmarks found in less than this fraction of the frames that should show them move, are
  /// hidden from here, or are wrong.
  double min_found_fraction = 0.8;
  /// The confidence is 1/2 where the standard deviation of the range is this fraction of the range.
  double half_confidence_error = 0.1;
  /// Points with less confidence are mostly wrong landmarks, which the network trusts too much.
  double min_confidence = 0.5;
};

}  // namespace orb360
