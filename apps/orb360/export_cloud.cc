#include "apps/orb360/export_cloud.h"

#include <iostream>
#include <string>

#include "apps/orb360/interrupt.h"
#include "apps/orb360/progress.h"

namespace orb360 {
namespace {

/// Says where coordinates lie, in one line.
std::string DescribeCoordinates(const LasCloud& cloud,
                                const std::optional<Georeference>& georeference) {
  if (!georeference) {
    return "coordinates are those of the run's world; `orb360 georeference` places a run on Earth, "
           "and the next export has a coordinate reference system";
  }
  if (!cloud.epsg) {
    return "coordinates are metres east, north and up of the origin in " +
           std::string(kGeoreferenceName) + ", because UTM is not defined there";
  }
  const AltitudeReference reference = georeference->altitude_reference;
  return "coordinates are UTM on WGS 84, EPSG:" + std::to_string(*cloud.epsg) +
         ", and heights over " +
         (reference == AltitudeReference::kEllipsoid      ? "the ellipsoid"
          : reference == AltitudeReference::kMeanSeaLevel ? "mean sea level"
                                                          : "what the positions had, unknown");
}

}  // namespace

LasCloud MeasureCloudOf(const FinishedRun& run, const std::optional<Georeference>& georeference) {
  return MeasureCloud(run.folder / "cloud.ply", georeference,
                      [](uint64_t) { ThrowIfInterrupted(); });
}

void WriteCloud(const LasCloud& cloud, const std::optional<Georeference>& georeference,
                const std::filesystem::path& out, bool is_quiet) {
  constexpr uint64_t kThousand = 1000;
  const uint64_t count = cloud.description.num_points;
  {
    Progress progress(std::nullopt, is_quiet);
    WriteLas(cloud, out / kLasName, [&](uint64_t done) {
      progress.Update("writing points", static_cast<int>(done / kThousand),
                      static_cast<int>(count / kThousand), "thousand");
      ThrowIfInterrupted();
    });
  }
  if (is_quiet) return;
  std::cout << DescribeCoordinates(cloud, georeference) << "\nwrote " << count << " points to "
            << (out / kLasName).string() << std::endl;
}

}  // namespace orb360
