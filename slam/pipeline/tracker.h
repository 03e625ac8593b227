#pragma once

#include <optional>
#include <vector>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/tracked_frame.h"

namespace orb360 {

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

struct TrackResult {
  Rigid3 world_from_camera;
  std::vector<LandmarkId> landmarks;  // as in TrackedFrame
  int num_inliers = 0;
  std::vector<LandmarkId> expected;  // landmarks that should have been seen, ordered by id
};

/// Pose of a frame that follows `last`. Landmarks of the last frame are searched around their
/// predicted positions, the pose refined, then the same with the whole local map. Where too few
/// matches agree, other starts are tried: P3P in RANSAC from landmarks of the last frame matched
/// from feature to feature, then the motion between both frames (frame_motion.h); the pose with
/// most landmarks wins. Empty where too little is found. `pixel_sigma` is the angular noise on
/// pyramid level 0, rad. Runs on `num_threads` OpenMP threads; the result does not depend on how
/// many.
std::optional<TrackResult> TrackFromPrediction(const Features& features,
                                               const Rigid3& predicted_world_from_camera,
                                               const TrackedFrame& last, const LocalMap& local,
                                               double pixel_sigma, const TrackerOptions& options,
                                               int num_threads = 1);

/// Pose of a frame without any prediction: descriptors of the local map against all features,
/// P3P in RANSAC, then as above.
std::optional<TrackResult> TrackWithoutPrediction(const Features& features, const LocalMap& local,
                                                  double pixel_sigma, const TrackerOptions& options,
                                                  int num_threads = 1);

}  // namespace orb360
