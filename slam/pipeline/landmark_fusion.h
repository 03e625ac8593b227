#pragma once

#include <span>
#include <vector>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// Fuses the landmarks of a keyframe with those of its `max_neighbours` best neighbours. The
/// landmarks of each are searched in the other. A landmark that is found there gets a further
/// observation, or is merged with the landmark that the feature has already.
void FuseWithNeighbours(KeyframeId keyframe, int max_neighbours, Map* map);

/// Does the same in one direction: searches `landmarks` in one keyframe, within `radius_sigmas`
/// standard deviations of their predicted positions. Ids of removed landmarks are ignored.
void FuseLandmarks(KeyframeId keyframe, std::span<const LandmarkId> landmarks, double radius_sigmas,
                   Map* map);

/// Returns the ids of all landmarks that some keyframes see, in increasing order.
std::vector<LandmarkId> LandmarksSeenBy(std::span<const KeyframeId> keyframes, const Map& map);

}  // namespace orb360
