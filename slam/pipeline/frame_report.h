#pragma once

#include <map>
#include <optional>
#include <string>

#include "slam/geometry/rigid3.h"

namespace orb360 {

enum class TrackingState { kInitializing, kTracking, kLost };

/// What became of one frame.
struct FrameReport {
  TrackingState state = TrackingState::kInitializing;
  std::optional<Rigid3> world_from_camera;  // as known now; System::Finish has the final pose
  int map = 0;                              // number of the present map, from 0
  int num_inliers = 0;                      // landmarks that agree with the pose
  int num_keyframes = 0;                    // of the present map, as far as it is adopted
  int num_landmarks = 0;
  /// Wall time by stage, ms: "extraction", "tracking", "adoption" (waiting for mapping) and
  /// "frame" for all together.
  std::map<std::string, double> timing_ms;
};

}  // namespace orb360
