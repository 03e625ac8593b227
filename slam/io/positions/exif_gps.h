#pragma once

#include <optional>
#include <string_view>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// The position of one image.
struct ExifPosition {
  GeodeticFix fix;  ///< Its timestamp is 0.
  AltitudeReference altitude_reference = AltitudeReference::kUnknown;
  std::optional<double> utc;  ///< GPSDateStamp and GPSTimeStamp, seconds since 1970.
};

/// Reads the GPS directory of an Exif block (JpegMetadata::exif). Returns nullopt where there is
/// none, or it is damaged, or has no position on Earth; any bytes are accepted.
///
/// Source: CIPA DC-008 (Exif 2.32), 4.6.6 "GPS attribute information"; TIFF 6.0 for the
/// directories.
std::optional<ExifPosition> ParseExifGps(std::string_view exif);

}  // namespace orb360
