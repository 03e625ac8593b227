#pragma once

#include <Eigen/Core>

namespace orb360 {

/// The ground that a camera moves over.
struct KnownGround {
  Eigen::Vector3d up;    ///< Normal towards the sky, unit vector, map frame.
  double camera_height;  ///< Height of the camera over the ground, in the map's unit.
  /// True where only completed depth shows the ground. It is then good enough for a first scale,
  /// but not to hold the scale later.
  bool is_rough = false;
};

}  // namespace orb360
