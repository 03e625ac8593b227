#pragma once

#include <memory>
#include <vector>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A frame whose pose is known.
struct TrackedFrame {
  int index = 0;         ///< Index in the sequence.
  double timestamp = 0;  ///< Seconds.
  std::shared_ptr<const Features> features;
  Rigid3 world_from_camera;
  /// By feature: the landmark of an inlier of the pose, kNoId elsewhere.
  std::vector<LandmarkId> landmarks;
  int num_inliers = 0;
};

/// Returns a keyframe as a tracked frame, all landmarks of which are inliers.
TrackedFrame MakeTracked(const Keyframe& keyframe);

}  // namespace orb360
