#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"
#include "slam/pipeline/local_map.h"

namespace orb360 {

struct TrackerOptions {
  /// Search windows around the predicted position, radians, tried in this order until enough
  /// landmarks of the last frame are found: smooth motion, then a jerk of the hand or a low frame
  /// rate.
  double narrow_radius = 0.05;
  double wide_radius = 0.2;
  /// Search window for the rest of the local map, in standard deviations of a feature's position.
  double local_radius_sigmas = 5.0;
  /// Matches of the last frame's landmarks that make the pose good enough to go on from.
  int min_motion_inliers = 20;
  /// Landmarks of the local map that make a frame tracked.
  int min_inliers = 30;
};

/// A frame whose pose is known.
struct TrackedFrame {
  int index = 0;         // in the sequence
  double timestamp = 0;  // s
  std::shared_ptr<const Features> features;
  Rigid3 world_from_camera;
  std::vector<LandmarkId> landmarks;  // by feature, inliers of the pose only; kNoId where none
  int num_inliers = 0;
};

struct TrackResult {
  Rigid3 world_from_camera;
  std::vector<LandmarkId> landmarks;  // as above
  int num_inliers = 0;
  std::vector<LandmarkId> expected;  // landmarks that should have been seen, ordered by id
};

/// Pose of a frame near to where it is predicted: landmarks of the last frame are searched around
/// their predicted positions and the pose refined, then the same with the whole local map.
/// Empty where too little is found. `pixel_sigma` is the angular noise on pyramid level 0, rad.
std::optional<TrackResult> TrackFromPrediction(const Features& features,
                                               const Rigid3& predicted_world_from_camera,
                                               const TrackedFrame& last, const LocalMap& local,
                                               double pixel_sigma, const TrackerOptions& options);

/// Pose of a frame without any prediction: descriptors of the local map against all features,
/// P3P in RANSAC, then as above.
std::optional<TrackResult> TrackWithoutPrediction(const Features& features, const LocalMap& local,
                                                  double pixel_sigma,
                                                  const TrackerOptions& options);

}  // namespace orb360
