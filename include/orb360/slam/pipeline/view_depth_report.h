#pragma once

#include <functional>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/depth/sparse_sample.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Receives before each frame, in each of two passes, how many of how many steps are done. False
/// makes the rest faster and less exact.
using ViewProgress = std::function<bool(int done, int count)>;

/// Receives what the network completes, view by view: image, and points from landmarks and stereo.
using SparseSampleSink = std::function<void(const SparseSample&)>;

/// Receives the depth of each reference view as soon as it is computed, in the unit of the world:
/// the index of its frame, its pose in the world of the reconstruction, and the depth.
using ViewDepthWatcher =
    std::function<void(int frame_index, const Rigid3& world_from_camera, const DenseDepth& depth)>;

/// What is called while depth is computed. Each may be null.
struct ViewDepthCallbacks {
  ViewProgress progress = {};     ///< How far it has got; ends stereo.
  SparseSampleSink sink = {};     ///< What the network completes.
  ViewDepthWatcher watcher = {};  ///< The depth of each view.
};

/// Of how many reference views stereo has measured a part, and why not of the others.
struct ViewDepthReport {
  int measured = 0;         ///< Views of which stereo has measured a part.
  int without_sources = 0;  ///< Those without two frames around them at a useful distance.
  /// Views in which an object that moves along with the camera was put on the ground.
  int with_moving_objects = 0;
  int unseen = 0;  ///< Those of which two frames agree on little, for want of texture.
};

}  // namespace orb360
