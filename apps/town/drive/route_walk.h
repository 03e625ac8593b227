#pragma once

#include <vector>

#include <Eigen/Core>

#include "apps/town/world/mesh.h"

namespace orb360::town {

/// Where somebody is and looks while walking.
struct WalkState {
  Eigen::Vector2d position;
  double heading = 0;   ///< radians, counter-clockwise from x, without jumps
  double distance = 0;  ///< walked since the start, metres
};

/// Returns points on a route of at least two places, 5 cm apart.
std::vector<Vector2f> ResampleRoute(const std::vector<Vector2f>& route);

/// A walk along a route, slower in bends.
class RouteWalk {
 public:
  /// Takes the speed on straight ways in metres per second.
  RouteWalk(const std::vector<Vector2f>& route, double speed);

  /// Returns the state at a time in seconds, clamped to the walk.
  WalkState At(double time) const;
  double duration() const;  ///< seconds

 private:
  std::vector<WalkState> states_;  // at even times
};

}  // namespace orb360::town
