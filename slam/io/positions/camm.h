#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// The positions in one sample of a track of camera motion metadata (CAMM).
struct CammPositions {
  /// Packets of the types 5 (position) and 6 (position, accuracy, time); their timestamps are 0,
  /// because the sample's is theirs.
  std::vector<GeodeticFix> with_accuracy, without_accuracy;
  /// Time of the first packet of type 6, seconds. By the specification it counts GPS time since
  /// 6 January 1980; some cameras write UTC since 1970.
  std::optional<double> gps_time;
  int num_without_lock = 0;  ///< Packets of type 6 that say that there was no fix.
};

/// Seconds from 1970 to the epoch of GPS time, less the leap seconds since (18, from 2017 on).
inline constexpr double kGpsEpoch = 315964800 - 18;

/// Reads a sample of a `camm` track, which may hold several packets. The horizontal accuracy is
/// taken as the radius that holds 68 % of the fixes. A packet that is cut off or of an unknown type
/// ends the sample; any bytes are accepted. Altitudes are over the WGS 84 ellipsoid.
///
/// Source: https://developers.google.com/streetview/publish/camm-spec (little-endian).
CammPositions ParseCamm(std::string_view sample);

}  // namespace orb360
