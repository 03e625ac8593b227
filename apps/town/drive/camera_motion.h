#pragma once

#include <cstdint>

#include "apps/town/drive/ride.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

struct CameraMotionOptions {
  uint64_t seed = 0;
  double height = 2;   ///< metres above the road, at right angles to it
  double pitch = 0;    ///< radians, nose up, of the camera on the car
  double roll = 0;     ///< radians, left side up, likewise
  double shaking = 1;  ///< factor on vibration, and on the body's pitch and roll in response to
                       ///< braking and bends
};

/// Returns the pose world_from_camera (camera -X forward, +Y right, +Z up), at a time, of a camera
/// on the roof of a car that drives a lap.
Rigid3 CameraPose(const Ride& ride, const CameraMotionOptions& options, double time);
/// As above, for a car that keeps to the lap's line.
inline Rigid3 CameraPose(const Lap& lap, const CameraMotionOptions& options, double time) {
  return CameraPose(Ride{.lap = &lap}, options, time);
}

}  // namespace orb360::town
