#pragma once

#include <Eigen/Core>

namespace orb360 {

/// The ground that a camera moves over.
struct KnownGround {
  Eigen::Vector3d up;    // unit, world
  double camera_height;  // in the map's unit
  /// True where only completed depth shows the ground. It is then good enough for a first scale,
  /// but not to hold the scale later.
  bool is_rough = false;
};

}  // namespace orb360
