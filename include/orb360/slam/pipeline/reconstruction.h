#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/pipeline/metric_scale.h>

namespace orb360 {

/// Pose of a frame in the map to which it belongs.
struct FramePose {
  /// Index in the sequence. It is negative for a frame of the run that made a loaded map.
  int index;
  double timestamp;  ///< Seconds.
  /// Index into Reconstruction::maps. Poses of different maps are related only by the motion that
  /// was assumed between the maps.
  int map;
  Rigid3 world_from_camera;  ///< Pose of the camera.
  /// Whether the pose lies between those of other frames, because this one showed nothing.
  bool is_interpolated = false;
  /// Index of the frame of a keyframe of the same map that sees the same; of a keyframe its own.
  int reference = 0;
};

/// A landmark of the result.
struct CloudPoint {
  Eigen::Vector3d position;  ///< World frame.
  Color color;               ///< Colour of the feature by which it was made.
};

/// Two keyframes that observe the same landmarks.
struct CovisibleFrames {
  size_t first;   ///< Index of one keyframe in Reconstruction::keyframes.
  size_t second;  ///< Index of the other keyframe in Reconstruction::keyframes.
  int shared;     ///< Number of landmarks that both observe.
};

/// One map of a reconstruction.
struct MapSummary {
  int first_frame = 0;     ///< Index of the first frame with a pose.
  int last_frame = 0;      ///< Index of the last frame with a pose.
  int tracked = 0;         ///< Number of frames with a pose.
  int keyframes = 0;       ///< Number of keyframes.
  int landmarks = 0;       ///< Number of landmarks.
  bool is_metric = false;  ///< Whether the unit of length is the metre.
};

/// A return of the camera to a place that it had seen before.
struct ClosedLoop {
  int frame;  ///< Index of the frame that came back.
  int place;  ///< Index of the frame that saw the place before, negative in a loaded map.
};

/// Everything that a run computed, in the internal frames (camera: -X forward, +Y right, +Z up).
struct Reconstruction {
  std::vector<FramePose> frames;     ///< Ordered by index.
  std::vector<FramePose> keyframes;  ///< Ordered by index.
  /// Pairs with at least 15 landmarks in common.
  std::vector<CovisibleFrames> covisibility;
  std::vector<CloudPoint> landmarks;  ///< Ordered by map.
  std::vector<MapSummary> maps;       ///< In the order of their start.
  MetricScale scale;                  ///< Of the whole result.
  /// The scale along the path, by map and keyframe.
  std::vector<KeyframeScale> keyframe_scales;
  /// Index of the frame at which the first map was made, or at which the camera was first localized
  /// in a loaded map. None where neither happened.
  std::optional<int> initialized_at;
  int lost = 0;         ///< How often tracking was lost after that.
  int relocalized = 0;  ///< How often a lost camera was found again.
  /// Number of frames whose view was covered for less than a second, with a pose between those of
  /// the frames before and after.
  int interpolated = 0;
  std::vector<ClosedLoop> loops;   ///< Loops that were closed within a map.
  std::vector<ClosedLoop> merges;  ///< Loops by which a map was merged into an older one.
  /// Mean number of a keyframe's features whose corner has a landmark.
  double features_per_keyframe = 0;
  /// Mean number of landmarks that a keyframe observes. A corner that has features on several
  /// levels counts once.
  double landmarks_per_keyframe = 0;
  /// Normal of the ground, unit, world frame, towards the sky. None where no ground was found.
  std::optional<Eigen::Vector3d> up;
};

}  // namespace orb360
