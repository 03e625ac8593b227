#pragma once

#include "slam/map/map.h"

namespace orb360 {

/// Looks for the landmarks of a keyframe's `max_neighbours` best neighbours where its image
/// should show them: about half of an image's corners are no corners in the next one, but what
/// surrounds them looks the same. Where a landmark's patch is found, the keyframe sees it: by a
/// corner without a landmark that is there, or by a new feature that is none (Keypoint::score), and
/// in both cases where the patch is. Where it sees another landmark already, nothing changes.
void FindByPatches(KeyframeId keyframe, int max_neighbours, Map* map);

}  // namespace orb360
