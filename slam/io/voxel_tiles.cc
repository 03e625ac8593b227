#include "slam/io/voxel_tiles.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

static_assert(std::is_trivially_copyable_v<Voxel>, "voxels are written byte by byte");

VoxelTiles::VoxelTiles(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::remove_all(folder_, error);
  if (!error) std::filesystem::create_directories(folder_, error);
  if (error) ThrowWriteError(folder_, error.value());
}

VoxelTiles::~VoxelTiles() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path VoxelTiles::PathOf(std::uint64_t tile) const {
  return folder_ / std::to_string(tile);
}

void VoxelTiles::Append(std::span<const Voxel> voxels) {
  std::map<std::uint64_t, std::vector<Voxel>> by_tile;
  for (const Voxel& voxel : voxels) by_tile[VoxelTile(voxel.key)].push_back(voxel);
  for (const auto& [tile, part] : by_tile) {
    OutputFile file(PathOf(tile), OutputFile::Mode::kAppend);
    file.Write({reinterpret_cast<const char*>(part.data()), part.size() * sizeof(Voxel)});
    counts_[tile] += part.size();
  }
}

void VoxelTiles::ForEach(const std::function<void(std::span<const Voxel>)>& take) const {
  for (const auto& [tile, count] : counts_) {
    std::vector<Voxel> voxels(count);
    std::ifstream file(PathOf(tile), std::ios::binary);
    file.read(reinterpret_cast<char*>(voxels.data()),
              static_cast<std::streamsize>(count * sizeof(Voxel)));
    if (!file) {
      throw UserError(PathOf(tile).string() +
                      ": is damaged or gone; keep the folder as it is until the run has ended");
    }
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
  }
}

}  // namespace orb360
