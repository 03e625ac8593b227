#pragma once

namespace orb360 {

class OptionSchema;

struct TrackerOptions {
  /// Search window around the predicted positions of the last frame's landmarks, radians: smooth
  /// motion.
  double motion_radius = 0.05;
  /// Angle within which features are matched with the last frame's where that convinces not,
  /// radians: a jerk of the hand, a low frame rate, a start.
  double nearby_radius = 0.3;
  /// Search window for the rest of the local map, in standard deviations of a feature's position.
  double local_radius_sigmas = 5.0;
  /// Matches of the last frame's landmarks that make the pose good enough to go on from.
  int min_motion_inliers = 20;
  /// Fraction of the local map's matches that must agree with the pose, or another start is tried:
  /// repeated texture lets the pose settle beside the truth.
  double min_inlier_ratio = 0.6;
  /// Landmarks of the local map that make a frame tracked.
  int min_inliers = 30;
};

/// Registers the keys of the section `tracker`.
void RegisterOptions(OptionSchema* schema, TrackerOptions* options);

}  // namespace orb360
