#include "slam/io/positions/georeference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <vector>

#include "nn/base/number_text.h"
#include "nn/base/statistics.h"
#include "slam/io/positions/utc_time.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Of phones and action cameras, which write no accuracy into GPX files.
constexpr double kDefaultSigma = 4.0;  // metres
// A receiver reports a place up to a second after the camera was there.
constexpr double kReceiverDelaySigma = 1.0;  // seconds

Positions InFrame(const PositionTrack& track, const GeodeticPoint& origin) {
  const Projection local = Projection::Local(origin);
  Positions positions;
  for (const GeodeticFix& fix : track.fixes) {
    PositionFix position;
    position.timestamp = fix.timestamp;
    position.position =
        local.FromGeodetic({fix.latitude, fix.longitude, fix.altitude.value_or(origin.height)});
    position.sigma = fix.horizontal_sigma.value_or(kDefaultSigma);
    if (fix.altitude) {
      position.vertical_sigma =
          fix.vertical_sigma.value_or(position.sigma * kVerticalPerHorizontal);
    }
    positions.fixes.push_back(position);
  }
  return positions;
}

void SetClock(const PositionTrack& track, const std::optional<double>& utc_at_zero,
              Positions* positions) {
  switch (track.clock) {
    case PositionClock::kFrames:
      break;
    case PositionClock::kVideo:
      positions->clock_offset_sigma = kReceiverDelaySigma;
      break;
    case PositionClock::kUtc:
      positions->clock_offset = utc_at_zero ? -*utc_at_zero : 0.0;
      positions->clock_offset_sigma =
          utc_at_zero ? kReceiverDelaySigma : std::numeric_limits<double>::infinity();
  }
}

/// The place of a fix; a fix without an altitude lies at the height 0.
GeodeticPoint PlaceOf(const GeodeticFix& fix) {
  return {fix.latitude, fix.longitude, fix.altitude.value_or(0.0)};
}

std::string Range(double first, double last, const PositionTrack& track) {
  if (track.clock == PositionClock::kUtc) {
    return FormatIsoTime(first) + " to " + FormatIsoTime(last);
  }
  return ToText(std::round(10 * first) / 10) + " s to " + ToText(std::round(10 * last) / 10) + " s";
}

[[noreturn]] void Refuse(const AlignmentResult& result, std::span<const PathPoint> path,
                         const PositionTrack& track) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << track.source << ": ";
  const double first = track.fixes.front().timestamp;
  const double last = track.fixes.back().timestamp;
  switch (result.failure) {
    case AlignmentFailure::kTooFewFixes:
      text << "fewer than " << kMinAlignmentFixes << " of its positions, from "
           << Range(first, last, track) << ", lie on the path of "
           << std::lround(path.back().timestamp - path.front().timestamp)
           << " s; give the track of this recording, and check the time that was given";
      break;
    case AlignmentFailure::kStandstill:
      text << "its positions or the camera do not move far enough to tell scale and heading";
      break;
    case AlignmentFailure::kNotThisPath:
      text << "its positions, from " << Range(first, last, track)
           << ", describe another path than the recording";
      if (result.median_distance > 0) {
        text << ": at best they are " << std::lround(result.median_distance) << " m apart";
      }
      text << "; give the track of this recording";
      break;
    case AlignmentFailure::kManyOffsets:
      text << "the path fits at several times equally well; give the time of the first frame with "
              "--utc-start";
      break;
    case AlignmentFailure::kNone:
      break;
  }
  throw UserError(text.str());
}

}  // namespace

LocalPositions MakeLocal(const PositionTrack& track, const std::optional<double>& utc_at_zero) {
  ORB360_CHECK(!track.fixes.empty(), track.source);
  const GeodeticPoint origin = PlaceOf(track.fixes[track.fixes.size() / 2]);
  LocalPositions local{origin, InFrame(track, origin)};
  SetClock(track, utc_at_zero, &local.positions);
  return local;
}

Georeference PlaceOnEarth(std::span<const PathPoint> path, const PositionTrack& track,
                          const PathKnowledge& known) {
  LocalPositions local = MakeLocal(track, known.utc_at_zero);
  AlignmentResult result = AlignPositions(path, local.positions, known.up, known.scale);
  if (!result.alignment) Refuse(result, path, track);
  // Far from its origin a local frame is not level, so it is moved to the path.
  const double middle = 0.5 * (path.front().timestamp + path.back().timestamp);
  const auto nearest = std::ranges::min_element(track.fixes, {}, [&](const GeodeticFix& fix) {
    return std::abs(fix.timestamp + result.alignment->clock_offset - middle);
  });
  const double clock_offset = result.alignment->clock_offset;
  Georeference georeference;
  georeference.origin = PlaceOf(*nearest);
  local.positions = InFrame(track, georeference.origin);
  SetClock(track, known.utc_at_zero, &local.positions);
  if (!std::isfinite(local.positions.clock_offset_sigma)) {
    // It has been found; only its neighbourhood is searched again.
    local.positions.clock_offset = clock_offset;
    local.positions.clock_offset_sigma =
        std::max(kReceiverDelaySigma, 10 * result.alignment->clock_offset_sigma);
  }
  result = AlignPositions(path, local.positions, known.up, known.scale);
  if (!result.alignment) Refuse(result, path, track);
  georeference.alignment = *result.alignment;
  georeference.altitude_reference = track.altitude_reference;
  georeference.utc_at_zero = track.utc_at_zero
                                 ? *track.utc_at_zero - georeference.alignment.clock_offset
                                 : known.utc_at_zero;
  georeference.source = track.source;
  return georeference;
}

}  // namespace orb360
