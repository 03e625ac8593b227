#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include <Eigen/Core>

#include "slam/io/export/las_writer.h"
#include "slam/io/positions/georeference.h"

namespace orb360 {

/// Called while a cloud is read, with the number of points so far. It may throw to stop.
using CloudProgress = std::function<void(std::uint64_t done)>;

/// A cloud that can be written as LAS: it was read once, and its bounds are known.
struct LasCloud {
  std::filesystem::path source;  ///< The cloud of a run (`cloud.ply`, of either kind).
  /// From the world of the run's files to the coordinates of the LAS file.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> file_from_world;
  std::optional<int> epsg;  ///< Code of the horizontal coordinate system, where there is one.
  LasDescription description;
};

/// Measures a cloud of any size, and chooses the coordinates. With a georeference these are easting
/// and northing in the zone of UTM on WGS 84 of its origin, and heights over its altitude
/// reference, metres; where UTM is not defined, near the poles, metres to the east, north and up
/// from the origin. Without one they are those of the run's world. Throws UserError where the cloud
/// is missing, damaged or empty, and where a georeference needs PROJ and this build has none.
LasCloud MeasureCloud(const std::filesystem::path& cloud,
                      const std::optional<Georeference>& georeference,
                      const CloudProgress& progress = nullptr);

/// Writes a measured cloud to `path` as LAS 1.4 (LasWriter), in the order of its points. The memory
/// does not depend on their number. Throws UserError.
void WriteLas(const LasCloud& cloud, const std::filesystem::path& path,
              const CloudProgress& progress = nullptr);

}  // namespace orb360
