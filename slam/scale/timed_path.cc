#include "slam/scale/timed_path.h"

#include <algorithm>

namespace orb360 {

std::optional<PathState> Interpolate(std::span<const PathPoint> path, double timestamp,
                                     double max_gap) {
  auto after = std::ranges::upper_bound(path, timestamp, {}, &PathPoint::timestamp);
  // The last point belongs to the last line.
  if (after == path.end() && !path.empty() && timestamp == path.back().timestamp) --after;
  if (after == path.begin() || after == path.end()) return std::nullopt;
  const PathPoint& before = *(after - 1);
  const double gap = after->timestamp - before.timestamp;
  if (!(gap > 0 && gap <= max_gap)) {
    for (const PathPoint& point : {before, *after}) {
      if (point.timestamp == timestamp) return PathState{point.position, Eigen::Vector3d::Zero()};
    }
    return std::nullopt;
  }
  const Eigen::Vector3d velocity = (after->position - before.position) / gap;
  return PathState{before.position + (timestamp - before.timestamp) * velocity, velocity};
}

}  // namespace orb360
