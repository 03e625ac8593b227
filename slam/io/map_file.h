#pragma once

#include <filesystem>
#include <optional>

#include "slam/geometry/rigid3.h"
#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"

namespace orb360 {

/// A map as it is kept for later runs.
struct StoredMap {
  int width = 0;  // of the pictures that it was made from, pixels
  /// The world of trajectories and clouds written with it: later runs write in the same one.
  Rigid3 file_world_from_map = {};
  std::optional<KnownGround> ground = {};  // none: the map is not in metres
  Map map = {};
};

/// One HDF5 file (docs/loops.md) with a digest, written atomically. Throws UserError where that
/// fails. Keyframes and landmarks get new ids, without gaps.
void WriteMap(const std::filesystem::path& path, const StoredMap& stored);

/// Throws UserError with one line that names the file for one that is missing, damaged, of another
/// version or no map.
StoredMap ReadMap(const std::filesystem::path& path);

}  // namespace orb360
