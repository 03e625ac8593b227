#pragma once

#include <orb360/slam/depth/dense_ground_options.h>
#include <orb360/slam/depth/sparse_depth_options.h>

namespace orb360 {

class OptionSchema;

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

/// Registers the keys of the section `depth`.
void RegisterOptions(OptionSchema* schema, DepthOptions* options);

}  // namespace orb360
