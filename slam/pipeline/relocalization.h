#pragma once

#include <optional>

#include "slam/features/features.h"
#include "slam/pipeline/atlas.h"
#include "slam/pipeline/local_map.h"
#include "slam/pipeline/options.h"
#include "slam/pipeline/tracker.h"

namespace orb360 {

/// Where a lost camera was found.
struct Relocalization {
  int map;  // its number in the atlas
  LocalMap local;
  TrackResult result;
};

/// Looks for a lost camera: around `local`, where it was seen last; at the places of all maps that
/// look most like its image; then around some keyframes of the present map, from the newest
/// backwards, round and round. `next_keyframe` says where that goes on in the next frame.
std::optional<Relocalization> Relocalize(const Features& features, const LocalMap& local,
                                         double pixel_sigma, const Options& options,
                                         int num_threads, Atlas* atlas, KeyframeId* next_keyframe);

}  // namespace orb360
