#include "slam/io/export/las.h"

#include <string>

#include "slam/io/ply.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Passes on each point in the coordinates of the LAS file.
void ReadPlaced(const LasCloud& cloud, const CloudProgress& progress,
                const std::function<void(const Eigen::Vector3d&, const SurfacePoint&)>& take) {
  constexpr std::uint64_t kPointsPerCall = 1 << 16;
  std::uint64_t done = 0;
  ReadCloudPoints(cloud.source, [&](const SurfacePoint& point) {
    take(cloud.file_from_world(point.position.cast<double>()), point);
    if (++done % kPointsPerCall == 0 && progress) progress(done);
  });
}

/// Chooses the coordinates of the file.
void ChooseCoordinates(const Georeference& georeference, LasCloud* cloud) {
  const Similarity3 local_from_world = georeference.alignment.local_from_path;
  cloud->epsg = UtmEpsg(georeference.origin);
  if (!cloud->epsg) {
    cloud->file_from_world = [local_from_world](const Eigen::Vector3d& point) {
      return local_from_world * point;
    };
    return;
  }
  cloud->description.wkt = WktOfEpsg(*cloud->epsg);
  cloud->file_from_world = [local_from_world, local = Projection::Local(georeference.origin),
                            utm = Projection::Utm(*cloud->epsg)](const Eigen::Vector3d& point) {
    return utm.FromGeodetic(local.ToGeodetic(local_from_world * point));
  };
}

}  // namespace

LasCloud MeasureCloud(const std::filesystem::path& cloud,
                      const std::optional<Georeference>& georeference,
                      const CloudProgress& progress) {
  LasCloud measured{cloud, [](const Eigen::Vector3d& point) { return point; }, {}, {}};
  if (georeference) ChooseCoordinates(*georeference, &measured);
  LasDescription& description = measured.description;
  description.has_confidence = IsSurfacePly(cloud);
  ReadPlaced(measured, progress, [&](const Eigen::Vector3d& position, const SurfacePoint&) {
    if (!position.allFinite()) {
      throw UserError(cloud.string() + ": is damaged (point " +
                      std::to_string(description.num_points) +
                      " is nowhere); run `orb360 run` again");
    }
    description.bounds.extend(position);
    ++description.num_points;
  });
  if (description.num_points == 0) throw UserError(cloud.string() + ": has no points to export");
  return measured;
}

void WriteLas(const LasCloud& cloud, const std::filesystem::path& path,
              const CloudProgress& progress) {
  LasWriter writer(path, cloud.description);
  ReadPlaced(cloud, progress, [&](const Eigen::Vector3d& position, const SurfacePoint& point) {
    writer.Append(position, point.rgb, point.confidence);
  });
  writer.Commit();
}

}  // namespace orb360
