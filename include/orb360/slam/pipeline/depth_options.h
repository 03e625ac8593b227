#pragma once

#include <orb360/slam/depth/dense_ground_options.h>
#include <orb360/slam/depth/sparse_depth_options.h>

namespace orb360 {

class OptionSchema;

/// How dense depth is made (docs/concepts/depth_completion.md).
struct DepthOptions {
  /// How landmarks become sparse depth for mapping (guides_mapping).
  SparseDepthOptions sparse = {.min_found_fraction = 0.8};
  /// How the ground is found in completed depth.
  DenseGroundOptions ground = {};
  /// Height of the images that are completed, pixels; they are twice as wide. Those of the input
  /// are not enlarged.
  int height = 512;
  /// Least distance between two views that get depth, divided by the median range of the
  /// surroundings. They are chosen among all frames, apart from the keyframes of mapping. 0: every
  /// frame whose image is kept, but of those at one place only the first.
  double view_spacing = 0.25;
  /// Least number of landmarks that a view shows. One with fewer is completed only where stereo has
  /// measured a part of it.
  int min_points = 50;
  /// Number of frames after which the depth of a keyframe is used in mapping (guides_mapping). It
  /// is completed meanwhile.
  int adoption_frames = 4;
  /// Whether completed ranges guide mapping and tracking. They helped in rendered towns and harmed
  /// elsewhere (docs/concepts/depth_completion.md), so that by default they do not.
  bool guides_mapping = false;
  /// Whether ranges are measured by multi-view stereo with the final poses at the end of a run.
  /// Otherwise the dense cloud is made of what the network completes from landmarks.
  bool stereo = true;
  /// Whether the depth of views has what the network completes. Otherwise it has only what
  /// stereo measures.
  bool completion = true;
};

/// Registers the keys of the section `depth`.
void RegisterOptions(OptionSchema* schema, DepthOptions* options);

}  // namespace orb360
