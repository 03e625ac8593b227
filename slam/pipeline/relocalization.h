#pragma once

#include <optional>

#include "slam/pipeline/atlas.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/tracker.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/pipeline/options.h>

namespace orb360 {

/// The pose at which a lost camera was found.
struct Relocalization {
  int map;  ///< Number of the map in the atlas.
  LocalMap local;
  TrackResult result;
  /// Whether it is where the motion before has taken the camera.
  bool continues_motion = false;
};

/// Searches a lost camera: in `local`, the map around its last pose; at those places of all maps
/// that are most similar to its image; then around some keyframes of the present map, from the
/// newest backwards and then from the newest again. `next_keyframe` is the keyframe at which the
/// next frame continues. Empty where the camera is not found.
std::optional<Relocalization> Relocalize(const Features& features, const LocalMap& local,
                                         double pixel_sigma, const Options& options,
                                         int num_threads, Atlas* atlas, KeyframeId* next_keyframe);

}  // namespace orb360
