#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// Parses the text of a GPX 1.0 or 1.1 file: all points `trkpt` of all tracks that have a time,
/// with `ele` (metres over mean sea level), `hdop` and `vdop` where given. The clock is UTC. Throws
/// UserError, which begins with `name`, for what is not GPX, a point without a place on Earth, a
/// time that is not ISO 8601, and a file without a point that has a time.
///
/// Source: GPX 1.1 schema, https://www.topografix.com/GPX/1/1/gpx.xsd.
PositionTrack ParseGpx(std::string_view text, const std::string& name);

/// Reads a file. Throws UserError, also for a file that cannot be opened, is empty, or is larger
/// than 256 MiB.
PositionTrack ReadGpx(const std::filesystem::path& path);

}  // namespace orb360
