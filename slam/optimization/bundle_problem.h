#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// A bundle adjustment problem: camera poses, points, and the measurements that tie them together,
/// which refer to poses and points by index. Solvers change the poses and points in place.
struct BundleProblem {
  /// A pose sees a point in a direction. See DirectionResidual.
  struct Observation {
    int pose;
    int point;
    Eigen::Vector3d bearing;  // unit, camera frame
    double sigma;             // angular noise, rad
  };
  /// A point of the ground lies `height` below the camera. See HeightResidual.
  struct Height {
    int pose;
    int point;
    Eigen::Vector3d normal;  // of the ground, unit, towards the camera, camera frame
    double height;           // in the world's unit
    double sigma;            // standard deviation as a fraction of the height
  };
  /// A range is known roughly from completed depth. See RangeResidual.
  struct Range {
    int pose;
    int point;
    double range;  // in the world's unit
    double sigma;  // standard deviation of the range's logarithm
  };
  std::vector<Rigid3> world_from_camera;
  std::vector<uint8_t> pose_fixed;  // by pose; at least one, or the gauge is free
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Height> heights;
  std::vector<Range> ranges;
};

}  // namespace orb360
