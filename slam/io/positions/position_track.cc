#include "slam/io/positions/position_track.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

bool IsFiniteOrNone(const std::optional<double>& number) {
  return !number || std::isfinite(*number);
}

bool IsPositiveOrNone(const std::optional<double>& number) {
  return !number || (std::isfinite(*number) && *number > 0);
}

}  // namespace

bool IsPlausible(const GeodeticFix& fix) {
  return std::isfinite(fix.timestamp) && std::abs(fix.latitude) <= 90 &&
         std::abs(fix.longitude) <= 180 && (fix.latitude != 0 || fix.longitude != 0) &&
         IsFiniteOrNone(fix.altitude) && IsPositiveOrNone(fix.horizontal_sigma) &&
         IsPositiveOrNone(fix.vertical_sigma);
}

void Tidy(PositionTrack* track) {
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
