#pragma once

#include <optional>
#include <string>
#include <vector>

namespace orb360 {

/// A position on Earth at a time, as a satellite receiver gives it.
struct GeodeticFix {
  double timestamp = 0;            ///< Seconds on the clock of the track.
  double latitude = 0;             ///< Degrees north, WGS 84.
  double longitude = 0;            ///< Degrees east, WGS 84.
  std::optional<double> altitude;  ///< Metres over PositionTrack::altitude_reference.
  /// Standard deviation in each horizontal direction, metres, where the source states its accuracy.
  std::optional<double> horizontal_sigma;
  std::optional<double> vertical_sigma;  ///< The same of the altitude.

  bool operator==(const GeodeticFix&) const = default;
};

/// What the timestamps of a track count from.
enum class PositionClock {
  kFrames,  ///< The clock of the frames: each fix belongs to one image.
  /// The start of the video in which the track is; a receiver may be late by a second.
  kVideo,
  kUtc  ///< UTC, seconds since 1970, by a clock that the frames know nothing of.
};

/// What altitudes are measured from.
enum class AltitudeReference { kUnknown, kEllipsoid, kMeanSeaLevel };

/// Name of a reference in files: "unknown", "WGS 84 ellipsoid" or "mean sea level".
const char* ToString(AltitudeReference reference);

/// The fixes of one source in the order of time; no two have the same time.
struct PositionTrack {
  std::string source;  ///< Format and file, to be shown to a user.
  PositionClock clock = PositionClock::kUtc;
  AltitudeReference altitude_reference = AltitudeReference::kUnknown;
  /// UTC at the timestamp 0, seconds since 1970, where the source tells it.
  std::optional<double> utc_at_zero;
  std::vector<GeodeticFix> fixes;
};

/// Standard deviation in each horizontal direction for a dilution of precision of 1, metres: what a
/// consumer's receiver has with single-frequency code under open sky.
inline constexpr double kMetresPerDop = 3.0;
/// Altitudes of receivers are about twice as uncertain as horizontal positions.
inline constexpr double kVerticalPerHorizontal = 2.0;

/// Whether latitude and longitude are on Earth, the time is within 231 years of the clock's zero,
/// all numbers are finite, and the position is not exactly 0, 0, which receivers write before they
/// know it.
bool IsPlausible(const GeodeticFix& fix);

/// Drops fixes and a UTC that are not plausible, sorts the fixes by time and drops those whose time
/// another one has already.
void Tidy(PositionTrack* track);

}  // namespace orb360
