#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/export/geographic_formats.h"
#include "slam/io/export/geographic_path.h"
#include "slam/io/json_text.h"

namespace orb360 {

void ExportGeojson(std::span<const PosedFrame> frames, const Georeference& georeference,
                   const std::filesystem::path& folder) {
  RequireLine(frames, "geojson");
  const GeographicPath path = PlaceFrames(frames, georeference);
  nlohmann::json coordinates = nlohmann::json::array();
  nlohmann::json timestamps = nlohmann::json::array();
  for (size_t i = 0; i < frames.size(); ++i) {
    const GeodeticPoint& place = path.places[i];
    coordinates.push_back({place.longitude, place.latitude, place.height});
    timestamps.push_back(frames[i].timestamp);
  }
  nlohmann::json properties = {{"altitude_reference", ToString(georeference.altitude_reference)},
                               {"source", georeference.source},
                               {"horizontal_sigma", georeference.alignment.horizontal_sigma},
                               {"timestamps", std::move(timestamps)}};
  if (!path.times.empty()) properties["times"] = path.times;
  const nlohmann::json feature = {
      {"type", "Feature"},
      {"properties", std::move(properties)},
      {"geometry", {{"type", "LineString"}, {"coordinates", std::move(coordinates)}}}};
  const nlohmann::json collection = {{"type", "FeatureCollection"}, {"features", {feature}}};
  WriteFileAtomically(folder / "trajectory.geojson", ToJsonText(collection) + "\n");
}

}  // namespace orb360
