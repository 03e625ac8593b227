#pragma once

#include <filesystem>
#include <optional>

#include <orb360/slam/geometry/rigid3.h>
#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// A map as it is stored for later runs.
struct StoredMap {
  /// Width of the images from which it was made, pixels.
  int width = 0;
  /// Pose of the map in the world of the trajectories and clouds that were written with it. Later
  /// runs write in the same world.
  Rigid3 file_world_from_map = {};
  /// Ground under the map, map frame. Without it, the map's unit of length is not the metre.
  std::optional<KnownGround> ground = {};
  /// Keyframes and landmarks. Images and patches of images are not stored.
  Map map = {};
};

/// Writes one HDF5 file with a digest (docs/formats/map.md) atomically. Throws UserError on
/// failure. Keyframes and landmarks get new ids without gaps.
void WriteMap(const std::filesystem::path& path, const StoredMap& stored);

/// Reads such a file. Throws UserError with one line that names the file if it is missing, damaged,
/// of another version or not a map.
StoredMap ReadMap(const std::filesystem::path& path);

}  // namespace orb360
