#include "slam/io/voxel_tiles.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace orb360 {

void VoxelTiles::Append(std::span<const Voxel> voxels) {
  std::map<std::uint64_t, std::vector<Voxel>> by_tile;
  for (const Voxel& voxel : voxels) by_tile[VoxelTile(voxel.key)].push_back(voxel);
  for (const auto& [tile, part] : by_tile) files_.Append(tile, part);
}

void VoxelTiles::ForEach(const std::function<void(std::span<const Voxel>)>& take) const {
  files_.ForEach([&take](std::uint64_t, std::vector<Voxel> voxels) {
    // The sort is stable so that parts of a voxel are added in the order in which they were
    // appended.
    std::ranges::stable_sort(voxels, {}, &Voxel::key);
    size_t last = 0;
    for (size_t i = 1; i < voxels.size(); ++i) {
      if (voxels[i].key == voxels[last].key) {
        voxels[last] += voxels[i];
      } else {
        voxels[++last] = voxels[i];
      }
    }
    take(std::span<const Voxel>(voxels).first(last + 1));
  });
}

}  // namespace orb360
