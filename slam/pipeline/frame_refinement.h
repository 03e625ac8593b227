#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/optimization/pose_refinement.h"
#include "slam/pipeline/tracker.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

/// The observation of a landmark in a frame.
struct Sighting {
  LandmarkId landmark;      ///< Its id when the frame was tracked.
  Eigen::Vector3f bearing;  ///< Unit, camera frame.
  float sigma;              ///< Angular noise, rad.
};

/// Returns the observations of landmarks in a tracked frame.
std::vector<Sighting> SightingsOf(const TrackedFrame& frame);

/// Refines the pose of a frame in the finished map. While the frame was tracked, its landmarks had
/// been adjusted only a few times. Where most of them still exist, they give a better pose now.
/// `world_from_camera` is the tracked pose after all corrections of the map; it is also the result
/// where too few landmarks are left. `prior`: what the keyframes before and after the frame tell of
/// its position (TrajectoryInterpolation), which matters where all landmarks are far; where the
/// result contradicts it by more than five standard deviations, its position is taken.
Rigid3 RefineFrame(const Map& map, const Rigid3& world_from_camera,
                   std::span<const Sighting> sightings,
                   const std::optional<PositionPrior>& prior = std::nullopt);

}  // namespace orb360
