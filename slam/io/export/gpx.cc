#include <sstream>

#include <pugixml.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/export/geographic_formats.h"
#include "slam/io/export/geographic_path.h"

namespace orb360 {

// Source: GPX 1.1 schema, https://www.topografix.com/GPX/1/1/gpx.xsd.
void ExportGpx(std::span<const PosedFrame> frames, const Georeference& georeference,
               const std::filesystem::path& folder) {
  const GeographicPath path = PlaceFrames(frames, georeference);
  pugi::xml_document document;
  pugi::xml_node gpx = document.append_child("gpx");
  gpx.append_attribute("version") = "1.1";
  gpx.append_attribute("creator") = "orb360";
  gpx.append_attribute("xmlns") = "http://www.topografix.com/GPX/1/1";
  gpx.append_child("metadata").append_child("desc").text() = DescribeOrigin(georeference).c_str();
  pugi::xml_node segment = gpx.append_child("trk").append_child("trkseg");
  for (size_t i = 0; i < path.places.size(); ++i) {
    const GeodeticPoint& place = path.places[i];
    pugi::xml_node point = segment.append_child("trkpt");
    point.append_attribute("lat") = DegreesText(place.latitude).c_str();
    point.append_attribute("lon") = DegreesText(place.longitude).c_str();
    point.append_child("ele").text() = HeightText(place.height).c_str();
    if (!path.times.empty()) point.append_child("time").text() = path.times[i].c_str();
  }
  std::ostringstream text;
  document.save(text, " ");
  WriteFileAtomically(folder / "trajectory.gpx", text.str());
}

}  // namespace orb360
