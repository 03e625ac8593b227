#pragma once

#include <map>
#include <optional>
#include <string>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

enum class TrackingState { kInitializing, kTracking, kLost };

/// The result of one frame.
struct FrameReport {
  TrackingState state = TrackingState::kInitializing;
  /// The pose as it is known now. System::Finish returns the final one.
  std::optional<Rigid3> world_from_camera;
  int map = 0;            ///< Number of the present map, from 0.
  int num_inliers = 0;    ///< Landmarks that agree with the pose.
  int num_keyframes = 0;  ///< Of the present map, without results that are not adopted yet.
  int num_landmarks = 0;
  /// Wall time by stage, ms: "extraction", "tracking", "adoption" (waiting for mapping), and
  /// "frame" for the whole frame.
  std::map<std::string, double> timing_ms;
};

}  // namespace orb360
