#pragma once

#include <functional>
#include <vector>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A frame with dense depth, in the unit of its pose.
struct DenseView {
  int frame_index = 0;
  int map = 0;  ///< Index into Reconstruction::maps.
  Rigid3 world_from_camera;
  /// Indices of the views that see the same landmarks, so that their poses fit this one's. Only
  /// those are compared.
  std::vector<size_t> neighbours;
  double timestamp = 0;  ///< Seconds.
};

/// Returns the depth of a frame, possibly several times for the same frame. The images must not
/// change afterwards. It is called on any thread, one call at a time, possibly while the sink runs.
using DepthLoader = std::function<DenseDepth(int frame_index)>;

}  // namespace orb360
