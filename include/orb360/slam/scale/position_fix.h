#pragma once

#include <Eigen/Core>

namespace orb360 {

/// Where something else has seen the camera, such as a satellite receiver.
struct PositionFix {
  double timestamp = 0;  ///< Seconds, on the clock of the frames.
  /// Metres, in any fixed right-handed frame.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double sigma = 0;  ///< Standard deviation in each direction, metres, positive.
};

}  // namespace orb360
