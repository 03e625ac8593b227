#pragma once

#include "slam/pipeline/initializer.h"
#include "slam/pipeline/pending_frames.h"
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/mapper_options.h>

namespace orb360 {

/// A map of two keyframes, and the frames from which they were made.
struct InitialMap {
  static constexpr KeyframeId kFirst = 0;
  static constexpr KeyframeId kSecond = 1;

  Map map;
  PendingFrame first;
  PendingFrame second;
};

/// Makes a map from two views and refines it. The first camera is the origin of the world; the unit
/// of length is arbitrary.
InitialMap MakeInitialMap(const PendingFrame& first, const PendingFrame& second,
                          const TwoViewMap& views, const MapperOptions& options);

}  // namespace orb360
