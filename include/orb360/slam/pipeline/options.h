#pragma once

#include <orb360/slam/features/orb_options.h>
#include <orb360/slam/pipeline/depth_options.h>
#include <orb360/slam/pipeline/initializer_options.h>
#include <orb360/slam/pipeline/keyframe_options.h>
#include <orb360/slam/pipeline/loop_options.h>
#include <orb360/slam/pipeline/mapper_options.h>
#include <orb360/slam/pipeline/recovery_options.h>
#include <orb360/slam/pipeline/scale_options.h>
#include <orb360/slam/pipeline/tracker_options.h>

namespace orb360 {

class OptionSchema;

/// Every setting of the system, by part. System throws ContractError, with key, value and range in
/// the message, for a setting out of range.
struct Options {
  /// Number of threads that the system may use at once; 0: as many as there are processors. No
  /// result depends on it.
  int num_threads = 0;
  OrbOptions orb;                  ///< Extraction of features.
  InitializerOptions initializer;  ///< The first map.
  TrackerOptions tracker;          ///< Poses of frames.
  KeyframeOptions keyframe;        ///< Selection of keyframes.
  MapperOptions mapper;            ///< Landmarks and local bundle adjustment.
  RecoveryOptions recovery;        ///< What follows a loss of tracking.
  ScaleOptions scale;              ///< Metric scale from the ground.
  DepthOptions depth;              ///< Depth completion.
  LoopOptions loop;                ///< Place recognition, loops and merges of maps.
};

/// Registers every option that has a key, in the order of the configuration file.
void RegisterOptions(OptionSchema* schema, Options* options);

}  // namespace orb360
