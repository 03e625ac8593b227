#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slam/optimization/pose_refinement.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Tells where a camera was between two keyframes, from their poses, and how surely: where the
/// keyframes lie on smooth arcs, so do the frames in between, and where they shake, the frames do
/// as well. The evidence of the landmarks overrules it wherever these are near enough to tell more.
class TrajectoryInterpolation {
 public:
  /// Takes the keyframes of a finished map that are of this run.
  explicit TrajectoryInterpolation(const Map& map);

  /// The position at a time, seconds. Empty outside the keyframes, where more than a second lies
  /// between two of them, where the video has been cut, and where fewer than two keyframes nearby
  /// show how smooth the motion is.
  std::optional<PositionPrior> PositionAt(double timestamp) const;

 private:
  struct Node {
    double timestamp;
    Rigid3 world_from_camera;
    /// Distance from the arc through the keyframes before and after it; negative where they are
    /// missing or far away in time.
    double deviation = -1;
  };

  /// Whether the camera cannot have moved from the node before `index` to it.
  bool IsCut(size_t index) const;

  std::vector<Node> nodes_;  // in the order of time
};

}  // namespace orb360
