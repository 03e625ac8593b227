#pragma once

#include "slam/map/map.h"

namespace orb360 {

/// Exchanges landmarks between a keyframe and its `max_neighbours` best neighbours: each one's
/// landmarks are searched in the other, where they become a further observation or, at a feature
/// that has a landmark of its own already, are merged with it.
void FuseWithNeighbours(KeyframeId keyframe, int max_neighbours, Map* map);

}  // namespace orb360
