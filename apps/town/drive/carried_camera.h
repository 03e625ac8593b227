#pragma once

#include <optional>
#include <string_view>

#include "apps/town/drive/route_walk.h"
#include "apps/town/image/random.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// The mounting of a camera, on the roof of a car or on whoever carries it.
struct Mount {
  std::optional<double> height;  ///< metres above the ground; without it, the drive's own
  double pitch = 0;              ///< radians, nose up
  double roll = 0;               ///< radians, left side up
  double shaking = 1;            ///< factor on vibration, on leaning in bends, on swaying
};

/// The way in which somebody who walks, or a small robot, carries a camera.
struct Carriage {
  double height = 1.5;  ///< metres above the ground
  double speed = 1;     ///< metres per second on straight ways
  double sway = 1;      ///< factor on the motion of walking
};

/// Draws a robot (0.3 to 0.8 m high) or somebody who walks (1.2 to 2.2 m), or takes the mount's
/// height; the mount's shaking scales the sway. A drawn height is at most `highest`, metres; throws
/// UserError that names `place` for a given one above it.
Carriage DrawCarriage(const Mount& mount, double highest, std::string_view place, Random random);

/// Returns world_from_camera (camera -X forward, +Y right, +Z up) at a time in seconds, at a state
/// of a walk, above ground of that height.
Rigid3 CarriedPose(const Carriage& carriage, const Mount& mount, const WalkState& state,
                   double ground, const Random& random, double seconds);

}  // namespace orb360::town
