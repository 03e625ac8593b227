#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

struct FramePose {
  /// Index in the sequence. It is negative for a frame of the run that made a loaded map.
  int index;
  double timestamp;  ///< Seconds.
  /// Poses of different maps are related only by the motion that was assumed between the maps.
  int map;
  Rigid3 world_from_camera;
};

struct CloudPoint {
  Eigen::Vector3d position;
  Color color;
};

/// Two keyframes that see the same landmarks.
struct CovisibleFrames {
  /// Indices into Reconstruction::keyframes.
  size_t first;
  size_t second;
  int shared;  ///< Number of landmarks that both see.
};

/// One map of a reconstruction.
struct MapSummary {
  /// Indices of the first and the last tracked frame.
  int first_frame = 0;
  int last_frame = 0;
  int tracked = 0;
  int keyframes = 0;
  int landmarks = 0;
  bool is_metric = false;  ///< Whether the unit of length is the metre.
  bool is_rough = false;   ///< Whether metres come from completed depth only.
};

/// Indices of the frame at which the camera came back to a place, and of the frame that saw the
/// place before.
struct ClosedLoop {
  int frame;
  int place;
};

/// Everything that a run computed, in the internal frames (camera: -X forward, +Y right, +Z up).
struct Reconstruction {
  std::vector<FramePose> frames;     ///< Ordered by index.
  std::vector<FramePose> keyframes;  ///< Ordered by index.
  /// Pairs with at least 15 landmarks in common.
  std::vector<CovisibleFrames> covisibility;
  std::vector<CloudPoint> landmarks;
  std::vector<MapSummary> maps;
  /// Index of the frame at which the first map was made.
  std::optional<int> initialized_at;
  int lost = 0;                    ///< How often tracking was lost after that.
  int relocalized = 0;             ///< How often a lost camera was found again.
  std::vector<ClosedLoop> loops;   ///< Loops that were closed within a map.
  std::vector<ClosedLoop> merges;  ///< Loops by which a map was merged into an older one.
  /// Mean number of corners of a keyframe that are observations of landmarks.
  double features_per_keyframe = 0;
  /// Mean number of landmarks of a keyframe. A corner that has features on several levels counts
  /// once.
  double landmarks_per_keyframe = 0;
  /// By frame index of the keyframes that have dense depth: number of units of the result in one
  /// unit of that depth.
  std::map<int, double> depth_scales;
  /// Normal of the ground, unit, world frame, towards the sky. None where no ground was found.
  std::optional<Eigen::Vector3d> up;
};

}  // namespace orb360
