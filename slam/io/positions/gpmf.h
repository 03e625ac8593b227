#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "slam/io/positions/position_track.h"

namespace orb360 {

/// The positions in one sample of a GoPro's telemetry track.
struct GpmfPositions {
  /// Timestamps are fractions of the sample's duration, from 0 up to but without 1: GPMF states no
  /// times, and the measurements of a sample are spread evenly over it.
  std::vector<GeodeticFix> fixes;
  /// UTC of the first measurement, seconds since 1970, where the receiver had it.
  std::optional<double> utc;
  AltitudeReference altitude_reference = AltitudeReference::kUnknown;
  /// Number of measurements that the receiver marked as made without satellites; they are not among
  /// `fixes`.
  int num_without_lock = 0;
};

/// Reads the stream GPS9 (HERO11 and later), or else GPS5, of a sample of a `gpmd` track. Both
/// state the dilution of precision, which becomes the standard deviation. What is damaged or of
/// another kind is left out, so that any bytes are accepted.
///
/// Source: https://github.com/gopro/gpmf-parser, README (KLV, types, the streams of each camera).
GpmfPositions ParseGpmf(std::string_view sample);

}  // namespace orb360
