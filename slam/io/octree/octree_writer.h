#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace orb360 {

struct OctreeOptions {
  /// Points sorted in memory at once, 32 bytes each: 96 MB. The bytes of the file do not depend on
  /// it.
  std::size_t max_in_memory = 3'000'000;
  /// Called every 65,536 points of each pass. What it throws ends the work, which leaves no file.
  std::function<void()> check;
};

/// Writes the octree (docs/formats/octree.md) of a cloud that ReadCloudPoints reads, which may be
/// larger than the memory; a folder `PATH.sort` has its points meanwhile. Returns the number of
/// points. Throws UserError for a file that is no cloud, for one without points, and if the disk
/// fails.
std::uint64_t WriteOctree(const std::filesystem::path& path, const std::filesystem::path& cloud,
                          const OctreeOptions& options = {});

}  // namespace orb360
