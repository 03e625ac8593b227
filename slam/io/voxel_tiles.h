#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <utility>

#include "slam/depth/voxel_grid.h"
#include "slam/io/tile_files.h"

namespace orb360 {

/// Voxels on disk, in one file for each cube of space (VoxelTile). The parts of voxels are added up
/// one cube at a time. Throws UserError if the disk fails.
class VoxelTiles {
 public:
  /// The folder lives as long as the object.
  explicit VoxelTiles(std::filesystem::path folder) : files_(std::move(folder)) {}

  /// Adds voxels, or parts of voxels.
  void Append(std::span<const Voxel> voxels);

  /// Passes on the voxels of each cube, complete and ordered by key, cube by cube in the order of
  /// their numbers.
  void ForEach(const std::function<void(std::span<const Voxel>)>& take) const;

 private:
  TileFiles<Voxel> files_;
};

}  // namespace orb360
