#pragma once

#include <filesystem>
#include <optional>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A map as it is stored for later runs.
struct StoredMap {
  int width = 0;  // of the images that it was made from, pixels
  /// Pose of the map in the world of the trajectories and clouds that were written with it. Later
  /// runs write in the same world.
  Rigid3 file_world_from_map = {};
  std::optional<KnownGround> ground = {};  // none: the map is not in metres
  Map map = {};
};

/// Writes one HDF5 file with a digest (docs/formats/map.md) atomically. Throws UserError on
/// failure. Keyframes and landmarks get new ids without gaps.
void WriteMap(const std::filesystem::path& path, const StoredMap& stored);

/// Reads such a file. Throws UserError with one line that names the file if it is missing, damaged,
/// of another version or not a map.
StoredMap ReadMap(const std::filesystem::path& path);

}  // namespace orb360
