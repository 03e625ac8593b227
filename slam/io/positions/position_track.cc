#include "slam/io/positions/position_track.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

// A receiver's clock counts from 1970 or from the start of a video: the years 1739 to 2201. So all
// sums of plausible times can be written as dates.
constexpr double kMaxTime = 7.3e9;  // seconds

bool IsPlausibleTime(double time) { return std::abs(time) <= kMaxTime; }

bool IsFiniteOrNone(const std::optional<double>& number) {
  return !number || std::isfinite(*number);
}

bool IsPositiveOrNone(const std::optional<double>& number) {
  return !number || (std::isfinite(*number) && *number > 0);
}

}  // namespace

bool IsPlausible(const GeodeticFix& fix) {
  return IsPlausibleTime(fix.timestamp) && std::abs(fix.latitude) <= 90 &&
         std::abs(fix.longitude) <= 180 && (fix.latitude != 0 || fix.longitude != 0) &&
         IsFiniteOrNone(fix.altitude) && IsPositiveOrNone(fix.horizontal_sigma) &&
         IsPositiveOrNone(fix.vertical_sigma);
}

void Tidy(PositionTrack* track) {
  if (track->utc_at_zero && !IsPlausibleTime(*track->utc_at_zero)) track->utc_at_zero.reset();
  std::vector<GeodeticFix>& fixes = track->fixes;
  std::erase_if(fixes, [](const GeodeticFix& fix) { return !IsPlausible(fix); });
  std::ranges::stable_sort(fixes, {}, &GeodeticFix::timestamp);
  const auto have_same_time = [](const GeodeticFix& a, const GeodeticFix& b) {
    return a.timestamp == b.timestamp;
  };
  fixes.erase(std::unique(fixes.begin(), fixes.end(), have_same_time), fixes.end());
}

const char* ToString(AltitudeReference reference) {
  switch (reference) {
    case AltitudeReference::kEllipsoid:
      return "WGS 84 ellipsoid";
    case AltitudeReference::kMeanSeaLevel:
      return "mean sea level";
    case AltitudeReference::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace orb360
