#pragma once

#include "slam/depth/dense_ground.h"
#include "slam/depth/sparse_depth.h"
#include "slam/features/orb_extractor.h"
#include "slam/io/config.h"
#include "slam/pipeline/initializer.h"
#include "slam/pipeline/loop_detector.h"
#include "slam/pipeline/mapper.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

struct KeyframeOptions {
  /// A frame becomes a keyframe when it tracks less than this fraction of the landmarks that its
  /// reference keyframe shares with others ...
  double min_tracked_fraction = 0.75;
  /// ... or has moved by this fraction of the median range of its surroundings.
  double max_motion = 0.1;
  /// Standing still adds nothing: the least motion, as above.
  double min_motion = 0.01;
  /// Frames after which the mapping of a keyframe is adopted; it runs beside tracking meanwhile.
  int mapping_frames = 6;
  /// Earlier when the landmarks tracked have fallen below this fraction of the keyframe's ...
  double min_held_fraction = 0.8;
  /// ... or below this number; then a keyframe is needed anyway.
  int urgent_inliers = 150;
  /// Keyframes around the reference whose landmarks tracking searches.
  int local_keyframes = 12;
};

struct RecoveryOptions {
  /// Frames without a pose after which a new map is begun, if that succeeds before relocalization.
  int patience_frames = 15;
  /// Keyframes of the map that are tried for each lost frame.
  int keyframes_per_frame = 3;
  /// Frames without a pose that are remembered, to be tracked backwards once there is a map. Of
  /// older ones only how the camera was turned is kept, if it has not moved.
  int max_pending_frames = 600;
};

/// Where metres come from: a camera moves at a known height over the ground that it sees.
struct ScaleOptions {
  /// Off: the scale of a map is arbitrary, and drifts.
  bool from_ground = true;
  /// Of the camera over the ground, metres; 0: unknown, kAssumedHeight is taken.
  double camera_height = 0;
  static constexpr double kAssumedHeight = 1.6;

  double height() const { return camera_height > 0 ? camera_height : kAssumedHeight; }
};

struct DepthOptions {
  SparseDepthOptions sparse = {};
  DenseGroundOptions ground = {};
  /// Of the images that are completed, pixels; they are twice as wide.
  int height = 512;
  /// Every so many keyframes are completed.
  int every_keyframes = 1;
  /// With fewer points there is nothing to complete.
  int min_points = 50;
  /// Frames after which the depth of a keyframe is used in mapping; it is completed meanwhile.
  int adoption_frames = 4;
};

/// Every setting of the system, by part.
struct Options {
  /// Threads that the system may use at once; 0: as many as there are processors. No result depends
  /// on it.
  int num_threads = 0;
  OrbOptions orb;
  InitializerOptions initializer;
  TrackerOptions tracker;
  KeyframeOptions keyframe;
  MapperOptions mapper;
  RecoveryOptions recovery;
  ScaleOptions scale;
  DepthOptions depth;
  LoopOptions loop;
};

/// Registers every option under its key in a configuration file. `options` must outlive the schema.
ConfigSchema MakeConfigSchema(Options* options);

}  // namespace orb360
