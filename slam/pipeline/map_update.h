#pragma once

#include <optional>
#include <vector>

#include "slam/geometry/rigid3.h"
#include "slam/map/map.h"
#include "slam/pipeline/frame_anchor.h"

namespace orb360 {

/// What a change of the present map means for everything that refers to it. Whatever moves the
/// world makes one: mapping, bundle adjustment, closing a loop, merging maps, rescaling, going on
/// in another map.
struct MapUpdate {
  /// The keyframe of the changed map around which tracking goes on.
  KeyframeId reference = kNoId;
  /// What moved the world around it.
  Similarity3 correction = {};
  /// What moved the world around each keyframe, by its id before the change (removed keyframes: the
  /// one that stands for them); empty where no keyframe has changed its scale.
  std::vector<Similarity3> corrections = {};
  /// Set where maps or their ids have other numbers now. Maps that get the same number have been
  /// merged.
  std::optional<MapRenumbering> renumbering = {};
};

/// Changes the unit of length: the new one is 1 / `factor` of the old one. The first keyframe stays
/// where it is. `reference`: the keyframe around which tracking goes on.
MapUpdate RescaleMap(double factor, KeyframeId reference, Map* map);

}  // namespace orb360
