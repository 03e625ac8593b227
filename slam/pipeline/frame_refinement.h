#pragma once

#include <span>

#include <Eigen/Core>

#include "slam/map/map.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// A landmark as a frame saw it.
struct Sighting {
  LandmarkId landmark;      // as it was called then
  Eigen::Vector3f bearing;  // unit, camera frame
  float sigma;              // angular noise, rad
};

/// The landmarks of a tracked frame.
std::vector<Sighting> SightingsOf(const TrackedFrame& frame);

/// Pose of a frame in the finished map. While it was tracked its landmarks were young, and only
/// those that were known by then gave its pose; where most are still there, they give a better one
/// now. `world_from_camera`: what came of the first one, also the result where they are not.
Rigid3 RefineFrame(const Map& map, const Rigid3& world_from_camera,
                   std::span<const Sighting> sightings);

}  // namespace orb360
