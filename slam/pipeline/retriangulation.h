#pragma once

#include <orb360/slam/map/map.h>

namespace orb360 {

/// Triangulates a landmark anew after keyframes that observe it have moved, if its observations
/// contradict its position. Where they contradict the new one as well, as those of what moves with
/// the camera do, the landmark is removed.
void Retriangulate(LandmarkId id, Map* map);

}  // namespace orb360
