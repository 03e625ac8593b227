#pragma once

#include <optional>

#include "slam/optimization/bundle_adjustment.h"
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/optimization/local_bundle_options.h>
#include <orb360/slam/optimization/optimizer.h>

namespace orb360 {

/// Adjusts the neighbourhood of a keyframe (paper Eq. 11): the poses of the keyframes around it and
/// all landmarks that they see. Afterwards it removes observations beyond the 95 % bound, and
/// landmarks with fewer than two observations left. Where the ground is known, the landmarks that
/// lie on it hold the scale: each keyframe should be the camera's height above the plane through
/// them.
void AdjustLocally(KeyframeId center, const LocalBundleOptions& options,
                   const std::optional<KnownGround>& ground, Map* map);

/// Adjusts the whole map in the same way, with its first keyframe fixed. Where enough keyframes see
/// the ground, the map is first scaled to the mean height. There are two rounds of `max_iterations`
/// each. At the ends of a loop, landmarks that merely look alike have become one, and a few dozen
/// of them bend the map; the first round finds and removes them, the second adjusts without them.
void AdjustGlobally(int max_iterations, const std::optional<KnownGround>& ground,
                    double height_sigma, Map* map, Optimizer optimizer = Optimizer::kSchur);

}  // namespace orb360
