#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// Where something else has seen the camera, such as a satellite receiver.
struct PositionFix {
  double timestamp = 0;  ///< Seconds, on the clock of the receiver (Positions::clock_offset).
  /// Metres to the east, to the north and up from any fixed place nearby.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double sigma = 0;  ///< Standard deviation in each horizontal direction, metres, positive.
  /// Standard deviation of the height, metres, positive; infinite where the height is unknown.
  double vertical_sigma = std::numeric_limits<double>::infinity();

  /// Whether all numbers but an infinite `vertical_sigma` are finite and the standard deviations
  /// are positive. Functions that take fixes throw ContractError, before anything else, where one
  /// is not.
  bool IsValid() const {
    return std::isfinite(timestamp) && position.allFinite() && std::isfinite(sigma) && sigma > 0 &&
           vertical_sigma > 0;
  }
};

/// Positions of a whole recording.
struct Positions {
  std::vector<PositionFix> fixes;  ///< In the order of time.
  /// Seconds to add to the timestamps of the fixes for the clock of the frames.
  double clock_offset = 0;
  /// Standard deviation of that, seconds: 0 where both clocks are one, infinite where nothing is
  /// known; then it is found from the shape of the path.
  double clock_offset_sigma = 0;
};

}  // namespace orb360
