#pragma once

#include <cmath>

#include <Eigen/Core>

namespace orb360 {

/// Where something else has seen the camera, such as a satellite receiver.
struct PositionFix {
  double timestamp = 0;  ///< Seconds, on the clock of the frames.
  /// Metres, in any fixed right-handed frame.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double sigma = 0;  ///< Standard deviation in each direction, metres, positive.

  /// Whether all numbers are finite and the standard deviation is positive. Functions that take
  /// fixes throw ContractError, before anything else, where one is not.
  bool IsValid() const {
    return std::isfinite(timestamp) && position.allFinite() && std::isfinite(sigma) && sigma > 0;
  }
};

}  // namespace orb360
