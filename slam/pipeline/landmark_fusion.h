#pragma once

#include <span>
#include <vector>

#include "slam/map/map.h"

namespace orb360 {

/// Exchanges landmarks between a keyframe and its `max_neighbours` best neighbours: each one's
/// landmarks are searched in the other, where they become a further observation or, at a feature
/// that has a landmark of its own already, are merged with it.
void FuseWithNeighbours(KeyframeId keyframe, int max_neighbours, Map* map);

/// The same in one direction: searches `landmarks` in one keyframe, within `radius_sigmas` standard
/// deviations of where they should be. Ids that are gone are passed over.
void FuseLandmarks(KeyframeId keyframe, std::span<const LandmarkId> landmarks, double radius_sigmas,
                   Map* map);

/// All landmarks that some keyframes see, ordered.
std::vector<LandmarkId> LandmarksSeenBy(std::span<const KeyframeId> keyframes, const Map& map);

}  // namespace orb360
