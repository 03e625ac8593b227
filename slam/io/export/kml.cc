#include <sstream>
#include <string>

#include <pugixml.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/export/geographic_formats.h"
#include "slam/io/export/geographic_path.h"

namespace orb360 {
namespace {

std::string Coordinates(const GeodeticPoint& place, char separator) {
  return DegreesText(place.longitude) + separator + DegreesText(place.latitude) + separator +
         HeightText(place.height);
}

}  // namespace

// Source: OGC 07-147r2 (KML 2.2) and https://developers.google.com/kml/documentation/kmlreference
// for gx:Track.
void ExportKml(std::span<const PosedFrame> frames, const Georeference& georeference,
               const std::filesystem::path& folder) {
  RequireLine(frames, "kml");
  const GeographicPath path = PlaceFrames(frames, georeference);
  pugi::xml_document document;
  pugi::xml_node kml = document.append_child("kml");
  kml.append_attribute("xmlns") = "http://www.opengis.net/kml/2.2";
  kml.append_attribute("xmlns:gx") = "http://www.google.com/kml/ext/2.2";
  pugi::xml_node placemark = kml.append_child("Document").append_child("Placemark");
  placemark.append_child("name").text() = "trajectory";
  placemark.append_child("description").text() = DescribeOrigin(georeference).c_str();
  const bool has_times = !path.times.empty();
  pugi::xml_node line = placemark.append_child(has_times ? "gx:Track" : "LineString");
  line.append_child("altitudeMode").text() = "absolute";
  if (has_times) {
    for (const std::string& time : path.times) line.append_child("when").text() = time.c_str();
    for (const GeodeticPoint& place : path.places) {
      line.append_child("gx:coord").text() = Coordinates(place, ' ').c_str();
    }
  } else {
    std::string coordinates;
    for (const GeodeticPoint& place : path.places) coordinates += Coordinates(place, ',') + ' ';
    coordinates.pop_back();
    line.append_child("coordinates").text() = coordinates.c_str();
  }
  std::ostringstream text;
  document.save(text, " ");
  WriteFileAtomically(folder / "trajectory.kml", text.str());
}

}  // namespace orb360
