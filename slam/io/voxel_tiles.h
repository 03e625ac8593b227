#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "slam/depth/voxel_grid.h"

namespace orb360 {

/// Voxels on disk, by the cube of space they are in (VoxelTile): as many as the disk holds, joined
/// one cube at a time. Throws UserError where the disk fails.
class VoxelTiles {
 public:
  /// Makes the folder, and removes it again in the end.
  explicit VoxelTiles(std::filesystem::path folder);
  ~VoxelTiles();
  VoxelTiles(const VoxelTiles&) = delete;
  VoxelTiles& operator=(const VoxelTiles&) = delete;

  /// Adds voxels, or parts of voxels.
  void Append(std::span<const Voxel> voxels);

  /// Gives the voxels of each cube, whole and ordered by key; cubes in the order of their numbers.
  void ForEach(const std::function<void(std::span<const Voxel>)>& take) const;

 private:
  std::filesystem::path PathOf(std::uint64_t tile) const;

  const std::filesystem::path folder_;
  std::map<std::uint64_t, std::uint64_t> counts_;  // of voxels appended, by tile
};

}  // namespace orb360
