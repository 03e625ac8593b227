#pragma once

#include <orb360/slam/map/map.h>

namespace orb360 {

/// Searches the landmarks of a keyframe's `max_neighbours` best neighbours at their predicted
/// positions in its image. About half of the corners of one image are not detected in the next one,
/// although their surroundings look the same. Where the patch of a landmark is found, the landmark
/// gets an observation at the position of the patch: by a corner without a landmark that lies
/// there, otherwise by a new feature that is not a corner (Keypoint::score). Where the keyframe has
/// an observation of another landmark already, nothing changes.
void FindByPatches(KeyframeId keyframe, int max_neighbours, Map* map);

}  // namespace orb360
