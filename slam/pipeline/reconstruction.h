#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

struct FramePose {
  int index;         // in the sequence; negative: of a run that a loaded map was made in
  double timestamp;  // s
  int map;           // poses of different maps are related only by the motion assumed between them
  Rigid3 world_from_camera;
};

struct CloudPoint {
  Eigen::Vector3d position;
  Color color;
};

/// Two keyframes that see the same landmarks.
struct CovisibleFrames {
  size_t first;  // indices into Reconstruction::keyframes
  size_t second;
  int shared;  // landmarks seen by both
};

/// One map of a reconstruction.
struct MapSummary {
  int first_frame = 0;  // indices of tracked frames
  int last_frame = 0;
  int tracked = 0;
  int keyframes = 0;
  int landmarks = 0;
  bool is_metric = false;  // else in a scale of its own
  bool is_rough = false;   // metres by completed depth only
};

/// The camera came back to a place; frame indices.
struct ClosedLoop {
  int frame;
  int place;
};

/// Everything a run computed, in the internal conventions of frames (camera -X forward).
struct Reconstruction {
  std::vector<FramePose> frames;              // ordered by index
  std::vector<FramePose> keyframes;           // ordered by index
  std::vector<CovisibleFrames> covisibility;  // with at least 15 landmarks in common
  std::vector<CloudPoint> landmarks;
  std::vector<MapSummary> maps;
  std::optional<int> initialized_at;  // frame at which the first map was made
  int lost = 0;                       // times tracking was lost after that
  int relocalized = 0;                // times a lost camera was found again
  std::vector<ClosedLoop> loops;      // closed within a map
  std::vector<ClosedLoop> merges;     // by which a map was merged into an older one
  double features_per_keyframe = 0;   // mean number of corners that are landmarks
  double landmarks_per_keyframe = 0;  // mean number it sees: a corner counts once
  /// Of the keyframes that were given dense depth, by frame index: units of the result in one unit
  /// of that depth.
  std::map<int, double> depth_scales;
  /// Normal of the ground in the world, unit, towards the sky; where one was found.
  std::optional<Eigen::Vector3d> up;
};

}  // namespace orb360
