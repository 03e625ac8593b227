#pragma once

#include <optional>
#include <vector>

#include "slam/pipeline/frame_anchor.h"
#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// Describes a change of the present map to everything that refers to the map. Mapping, bundle
/// adjustment, closing a loop, merging maps, rescaling and going on in another map return one.
struct MapUpdate {
  /// The keyframe of the changed map around which tracking goes on.
  KeyframeId reference = kNoId;
  /// The similarity that moved the world around it.
  Similarity3 correction = {};
  /// The similarity that moved the world around each keyframe, by its id before the change (for a
  /// removed keyframe, that of the keyframe that replaces it). Empty where no keyframe has changed
  /// its scale.
  std::vector<Similarity3> corrections = {};
  /// Set where the numbers of maps or the ids in them have changed. Maps that get the same number
  /// have been merged.
  std::optional<MapRenumbering> renumbering = {};
};

/// Changes the unit of length of a map: the new one is 1 / `factor` of the old one. The position of
/// the first keyframe does not change. `reference` is the keyframe around which tracking goes on.
MapUpdate RescaleMap(double factor, KeyframeId reference, Map* map);

}  // namespace orb360
