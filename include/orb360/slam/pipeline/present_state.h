#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/io/frame_source.h>
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/frame_report.h>
#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// What a System knows right after it has tracked a frame, for showing it. References and pointers
/// are valid during the call of the watcher only.
struct PresentState {
  const Frame& frame;        ///< The frame, with its image.
  TrackingState state;       ///< State after this frame.
  const Features& features;  ///< Features of the frame.
  /// For each feature the landmark of an inlier of the pose, kNoId elsewhere. Empty unless
  /// tracking.
  std::span<const LandmarkId> landmarks = {};
  std::optional<Rigid3> map_from_camera = {};  ///< Pose in the present map, in kTracking only.
  int map_number = 0;                          ///< Number of the present map, from 0.
  /// The present map; null while a job owns it, as it does after most frames.
  const Map* map = nullptr;
  std::optional<KnownGround> ground =
      {};  ///< The ground under the present map; with one it is metric.
  std::span<const ClosedLoop> loops = {};  ///< Loops closed so far.
};

/// Looks at the state after each frame, on the thread that calls System::Process. It cannot change
/// any result.
using Watcher = std::function<void(const PresentState&)>;

}  // namespace orb360
