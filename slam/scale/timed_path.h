#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace orb360 {

/// A place on an estimated path.
struct PathPoint {
  double timestamp;          ///< Seconds.
  Eigen::Vector3d position;  ///< In the map's unit of length.
};

/// Where the camera was at a time between two points of a path, and how fast it was.
struct PathState {
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;  ///< Units of the map a second.
};

/// Interpolates a path, whose times ascend, on the straight line between the two points around
/// `timestamp`. Returns nullopt before the first and after the last point, and where the two are
/// more than `max_gap` seconds apart; there only the points themselves are known, and no velocity.
std::optional<PathState> Interpolate(std::span<const PathPoint> path, double timestamp,
                                     double max_gap);

}  // namespace orb360
