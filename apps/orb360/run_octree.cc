#include "apps/orb360/run_octree.h"

#include <iostream>
#include <system_error>

#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_writer.h"
#include "slam/io/ply.h"

namespace orb360 {

std::optional<std::filesystem::path> ProvideOctree(const std::filesystem::path& run,
                                                   bool is_quiet) {
  const std::filesystem::path cloud = run / "cloud.ply";
  const std::filesystem::path path = run / kOctreeName;
  if (!std::filesystem::exists(cloud)) {
    if (std::filesystem::exists(path)) return path;
    return std::nullopt;
  }
  std::error_code error;
  const auto made = std::filesystem::last_write_time(path, error);
  if (!error && made >= std::filesystem::last_write_time(cloud)) return path;
  struct Any {};
  try {  // A run whose only map was empty has a cloud without points.
    ReadCloudPoints(cloud, [](const SurfacePoint&) { throw Any(); });
    return std::nullopt;
  } catch (const Any&) {
  }
  if (!is_quiet) std::cout << "making levels of detail of " << cloud.string() << std::endl;
  WriteOctree(path, cloud);
  return path;
}

}  // namespace orb360
