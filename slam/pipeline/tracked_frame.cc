#include "slam/pipeline/tracked_frame.h"

#include <algorithm>

namespace orb360 {

TrackedFrame MakeTracked(const Keyframe& keyframe) {
  const auto num_landmarks =
      std::ranges::count_if(keyframe.landmarks, [](LandmarkId id) { return id != kNoId; });
  return {.index = keyframe.frame_index,
          .timestamp = keyframe.timestamp,
          .features = keyframe.features,
          .world_from_camera = keyframe.world_from_camera,
          .landmarks = keyframe.landmarks,
          .num_inliers = static_cast<int>(num_landmarks)};
}

}  // namespace orb360
