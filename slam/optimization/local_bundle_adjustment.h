#pragma once

#include <optional>
#include <span>

#include "slam/map/map.h"
#include "slam/optimization/bundle_adjustment.h"

namespace orb360 {

/// The larger the window, the less the scale of a long drive drifts, and the longer it takes.
struct LocalBundleOptions {
  /// Keyframes that move: the newest and those that share most landmarks with it.
  int max_keyframes = 10;
  /// Keyframes beyond, which see the same landmarks and hold them in place.
  int max_fixed_keyframes = 16;
  /// Landmarks that a keyframe must share with the newest to move.
  int min_shared = 15;
  int max_iterations = 4;
  /// Standard deviation of the camera's height over the plane through the ground around it, as a
  /// share: roads are not flat, and cameras sway.
  double height_sigma = 0.01;
};

/// The ground that a camera moves over.
struct KnownGround {
  Eigen::Vector3d up;    // unit, world
  double camera_height;  // in the map's unit
  /// Seen in completed depth only: good for a first scale, not to hold it by.
  bool is_rough = false;
};

/// Bundle adjustment of the neighbourhood of a keyframe (paper Eq. 11): poses of the keyframes
/// around it and all landmarks they see. Afterwards observations beyond the 95 % bound are removed,
/// and landmarks with fewer than two left. Where the ground is known, the landmarks that lie on it
/// hold the scale: each keyframe is to be the camera's height above the plane through them.
void AdjustLocally(KeyframeId center, const LocalBundleOptions& options,
                   const std::optional<KnownGround>& ground, Map* map);

/// The same for the whole map; its first keyframe is held. Where enough keyframes see the ground,
/// the map is scaled to the height in the mean first. In two rounds of `max_iterations` each: at
/// the ends of a loop, landmarks that merely look alike have become one, and a few dozen of them
/// bend the map. The first round finds what is wrong, the second does without it.
void AdjustGlobally(int max_iterations, const std::optional<KnownGround>& ground,
                    double height_sigma, Map* map);

}  // namespace orb360
