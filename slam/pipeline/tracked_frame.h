#pragma once

#include <memory>
#include <vector>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"
#include "slam/map/map.h"

namespace orb360 {

/// A frame whose pose is known.
struct TrackedFrame {
  int index = 0;         // in the sequence
  double timestamp = 0;  // s
  std::shared_ptr<const Features> features;
  Rigid3 world_from_camera;
  std::vector<LandmarkId> landmarks;  // by feature, inliers of the pose only; kNoId where none
  int num_inliers = 0;
};

/// A keyframe as if it had just been tracked: all of its landmarks are inliers.
TrackedFrame MakeTracked(const Keyframe& keyframe);

}  // namespace orb360
