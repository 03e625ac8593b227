#pragma once

#include <optional>

#include "slam/pipeline/map_update.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

/// A job that adjusts a copy of the whole map, beside tracking and mapping.
struct GlobalAdjustment {
  Map map;
  std::optional<KnownGround> ground;
};

struct AdjustedMap {
  Map before;
  Map after;
};

AdjustedMap AdjustMap(GlobalAdjustment job, const Options& options);

/// Applies the result to the map that was copied, which has changed in the meantime. `reference` is
/// the keyframe around which tracking goes on.
MapUpdate TakeOver(const AdjustedMap& adjusted, KeyframeId reference, Map* map);

}  // namespace orb360
