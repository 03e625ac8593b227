#pragma once

#include <map>
#include <optional>
#include <string>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// What tracking knows of the present frame.
enum class TrackingState {
  kInitializing,  ///< There is no map yet.
  kTracking,      ///< The pose of the frame in the present map is known.
  kLost,          ///< There is a map, but the pose of the frame in it is not known.
};

/// The result of one frame.
struct FrameReport {
  /// State after this frame.
  TrackingState state = TrackingState::kInitializing;
  /// Pose as it is known now, in kTracking only. System::Finish returns the final one.
  std::optional<Rigid3> world_from_camera;
  int map = 0;            ///< Number of the present map, from 0.
  int num_inliers = 0;    ///< Landmarks that agree with the pose.
  int num_keyframes = 0;  ///< Keyframes of the present map, without results not adopted yet.
  int num_landmarks = 0;  ///< Landmarks of the present map, likewise.
  /// Wall time by stage, ms: "extraction", "tracking", "adoption" (waiting for mapping), and
  /// "frame" for the whole frame.
  std::map<std::string, double> timing_ms;
};

}  // namespace orb360
