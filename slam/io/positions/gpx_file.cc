#include "slam/io/positions/gpx_file.h"

#include <cmath>
#include <cstring>

#include <pugixml.hpp>

#include "nn/base/number_text.h"
#include "slam/io/positions/file_head.h"
#include "slam/io/positions/utc_time.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr size_t kMaxBytes = size_t{256} << 20;  // three weeks at 10 Hz

/// Whether an element has the given name in any namespace.
bool IsNamed(const pugi::xml_node& node, std::string_view name) {
  const std::string_view full = node.name();
  const size_t colon = full.find(':');
  return (colon == std::string_view::npos ? full : full.substr(colon + 1)) == name;
}

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// The finite number in a child element; none where there is no such child or no number in it.
std::optional<double> NumberIn(const pugi::xml_node& point, std::string_view name) {
  for (const pugi::xml_node child : point.children()) {
    if (!IsNamed(child, name)) continue;
    const std::optional<double> number = ParseNumber<double>(Trimmed(child.child_value()));
    if (number && std::isfinite(*number)) return number;
  }
  return std::nullopt;
}

std::string_view TimeIn(const pugi::xml_node& point) {
  for (const pugi::xml_node child : point.children()) {
    if (IsNamed(child, "time")) return Trimmed(child.child_value());
  }
  return {};
}

/// Standard deviation for a dilution of precision; none for one that is absent or not positive.
std::optional<double> SigmaOf(const std::optional<double>& dop, double metres_per_dop) {
  if (!dop || !(*dop > 0)) return std::nullopt;
  return *dop * metres_per_dop;
}

/// Throws UserError, which begins with `where`. None for a point without a time.
std::optional<GeodeticFix> ParsePoint(const pugi::xml_node& point, const std::string& where) {
  const std::string_view time = TimeIn(point);
  if (time.empty()) return std::nullopt;
  GeodeticFix fix;
  const std::optional<double> seconds = ParseIsoTime(time);
  if (!seconds) {
    throw UserError(where + "`" + std::string(time.substr(0, 40)) +
                    "` is not a time such as 2025-03-14T07:00:00Z");
  }
  fix.timestamp = *seconds;
  const auto degrees = [&](const char* name, double max) {
    const std::string_view text = point.attribute(name).value();
    const std::optional<double> value = ParseNumber<double>(Trimmed(text));
    if (value && std::abs(*value) <= max) return *value;
    throw UserError(where + name + "=\"" + std::string(text.substr(0, 40)) +
                    "\" is not an angle in degrees on Earth");
  };
  fix.latitude = degrees("lat", 90);
  fix.longitude = degrees("lon", 180);
  fix.altitude = NumberIn(point, "ele");
  fix.horizontal_sigma = SigmaOf(NumberIn(point, "hdop"), kMetresPerDop);
  fix.vertical_sigma = SigmaOf(NumberIn(point, "vdop"), kMetresPerDop);
  return fix;
}

}  // namespace

PositionTrack ParseGpx(std::string_view text, const std::string& name) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_auto);
  if (!parsed) {
    throw UserError(name + ": is damaged XML at byte " + std::to_string(parsed.offset) + ": " +
                    parsed.description() + "; export the track again");
  }
  const pugi::xml_node root = document.document_element();
  if (!IsNamed(root, "gpx")) {
    throw UserError(name + ": is XML, but no GPX file; export the track as GPX");
  }
  PositionTrack track;
  track.source = "GPX " + name;
  track.clock = PositionClock::kUtc;
  track.altitude_reference = AltitudeReference::kMeanSeaLevel;
  track.utc_at_zero = 0.0;
  int num_points = 0;
  for (const pugi::xml_node trk : root.children()) {
    if (!IsNamed(trk, "trk")) continue;
    for (const pugi::xml_node segment : trk.children()) {
      if (!IsNamed(segment, "trkseg")) continue;
      for (const pugi::xml_node point : segment.children()) {
        if (!IsNamed(point, "trkpt")) continue;
        const std::string where = name + ": point " + std::to_string(++num_points) + ": ";
        if (const std::optional<GeodeticFix> fix = ParsePoint(point, where)) {
          track.fixes.push_back(*fix);
        }
      }
    }
  }
  Tidy(&track);
  if (num_points == 0) {
    throw UserError(name + ": contains no track point (trkpt); give the recorded track");
  }
  if (track.fixes.empty()) {
    throw UserError(name + ": none of its " + std::to_string(num_points) +
                    " points has a time, without which they cannot be matched with frames; give "
                    "the track as the receiver recorded it");
  }
  return track;
}

PositionTrack ReadGpx(const std::filesystem::path& path) {
  return ParseGpx(ReadWholeFile(path, kMaxBytes), path.string());
}

}  // namespace orb360
