#pragma once

namespace orb360 {

class OptionSchema;

/// How the pose of a frame is found (docs/concepts/tracking.md).
struct TrackerOptions {
  /// Radius of the search around the predicted directions of the last frame's landmarks, radians.
  /// It is enough for smooth motion.
  double motion_radius = 0.05;
  /// Angle within which features are matched with the last frame's, radians, where the prediction
  /// gives no convincing pose: after a jerk of the hand, at a low frame rate, at a start.
  double nearby_radius = 0.3;
  /// Radius of the search for the landmarks of the local map, in standard deviations of a feature's
  /// position.
  double local_radius_sigmas = 5.0;
  /// Least number of the last frame's landmarks that must agree with a pose from which the search
  /// in the local map starts.
  int min_motion_inliers = 20;
  /// Least fraction of the matches with the local map that must agree with the pose. With less,
  /// another start is tried, because repeated texture lets the pose settle beside the truth.
  double min_inlier_ratio = 0.6;
  /// Least number of landmarks of the local map that must agree with the pose of a tracked frame.
  int min_inliers = 30;
};

/// Registers the keys of the section `tracker`.
void RegisterOptions(OptionSchema* schema, TrackerOptions* options);

}  // namespace orb360
