#include "apps/orb360/run_octree.h"

#include <iostream>
#include <system_error>

#include "apps/orb360/interrupt.h"
#include "slam/io/atomic_file.h"
#include "slam/io/octree/octree_format.h"
#include "slam/io/octree/octree_writer.h"
#include "slam/io/ply.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

std::optional<std::filesystem::path> ProvideOctree(const std::filesystem::path& run, bool is_quiet,
                                                   std::vector<std::string>* missing) {
  constexpr const char* kNoPoints = "Points: the folder has no cloud.ply with points.";
  const std::filesystem::path cloud = run / "cloud.ply";
  const std::filesystem::path path = run / kOctreeName;
  if (!std::filesystem::exists(cloud)) {
    if (std::filesystem::exists(path)) return path;
    missing->emplace_back(kNoPoints);
    return std::nullopt;
  }
  std::error_code error;
  const auto made = std::filesystem::last_write_time(path, error);
  if (!error && made >= std::filesystem::last_write_time(cloud)) return path;
  struct Any {};
  try {  // A run whose only map was empty has a cloud without points.
    ReadCloudPoints(cloud, [](const SurfacePoint&) { throw Any(); });
    missing->emplace_back(kNoPoints);
    return std::nullopt;
  } catch (const Any&) {
  }
  try {
    AtomicFile{path};
  } catch (const UserError&) {
    missing->emplace_back(
        "Points: the folder cannot be written to, and the first `orb360 view` has to write the "
        "levels of detail of the cloud (cloud.octree) there. Copy the run to show them.");
    return std::nullopt;
  }
  if (!is_quiet) std::cout << "making levels of detail of " << cloud.string() << std::endl;
  WriteOctree(path, cloud, {.check = ThrowIfInterrupted});
  return path;
}

}  // namespace orb360
