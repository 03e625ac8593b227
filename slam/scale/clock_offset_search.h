#pragma once

#include <span>
#include <vector>

#include "slam/scale/timed_path.h"
#include <orb360/slam/scale/position_fix.h>

namespace orb360 {

/// Gaps up to this many seconds are crossed on a straight line, in paths and between fixes.
inline constexpr double kMaxPathGap = 4.0;

/// Offsets between the clocks of `path` and of `positions`, seconds, at which the positions from
/// above may be a similarity transform of the path: those of the best local maxima of the squared
/// correlation of both (a complex number for each place, so that the correlation does not depend on
/// heading, scale and origin), the best one first, up to eight. The path must be levelled: its z
/// axis points up, roughly. A known offset is the only candidate; one with a standard deviation is
/// sought within three of these; one of which nothing is known wherever both overlap by half the
/// shorter one's duration.
std::vector<double> FindClockOffsets(std::span<const PathPoint> path, const Positions& positions);

}  // namespace orb360
