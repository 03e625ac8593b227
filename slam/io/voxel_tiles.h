#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "slam/depth/voxel_grid.h"

namespace orb360 {

/// Voxels on disk, in one file for each cube of space (VoxelTile). Their number is limited by the
/// disk only; the parts of voxels are added up one cube at a time. Throws UserError if the disk
/// fails.
class VoxelTiles {
 public:
  /// Creates the folder; the destructor removes it.
  explicit VoxelTiles(std::filesystem::path folder);
  ~VoxelTiles();
  VoxelTiles(const VoxelTiles&) = delete;
  VoxelTiles& operator=(const VoxelTiles&) = delete;

  /// Adds voxels, or parts of voxels.
  void Append(std::span<const Voxel> voxels);

  /// Passes on the voxels of each cube, complete and ordered by key, cube by cube in the order of
  /// their numbers.
  void ForEach(const std::function<void(std::span<const Voxel>)>& take) const;

 private:
  std::filesystem::path PathOf(std::uint64_t tile) const;

  const std::filesystem::path folder_;
  std::map<std::uint64_t, std::uint64_t> counts_;  // of voxels appended, by tile
};

}  // namespace orb360
