#pragma once

#include <cstdint>
#include <vector>

#include "apps/town/world/street_plan.h"
#include "slam/geometry/rigid3.h"

namespace orb360::town {

struct DriveOptions {
  uint64_t seed = 0;
  int frames = 600;
  double fps = 20;
  double camera_height = 2;  ///< metres above the road
  double minimum_speed = 5;  ///< metres per second, on straight stretches
  double maximum_speed = 12;
};

/// Poses world_from_camera (camera -X forward, +Y right, +Z up), one per frame, of a camera on a
/// car that drives the plan's tour round and round in the right-hand lane: it slows down for
/// bends, stops at some junctions, and pitches, rolls and shakes a little.
std::vector<Rigid3> DriveTour(const StreetPlan& plan, const DriveOptions& options);

}  // namespace orb360::town
