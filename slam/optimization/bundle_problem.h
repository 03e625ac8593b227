#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A bundle adjustment problem: camera poses, points, and the measurements that tie them together,
/// which refer to poses and points by index. Solvers change the poses and points in place.
struct BundleProblem {
  /// A pose sees a point in a direction. See DirectionResidual.
  struct Observation {
    int pose;
    int point;
    Eigen::Vector3d bearing;  ///< Unit, camera frame.
    double sigma;             ///< Angular noise, rad.
  };
  /// A point of the ground lies `height` below the camera. See HeightResidual.
  struct Height {
    int pose;
    int point;
    /// Normal of the ground, unit, towards the camera, camera frame.
    Eigen::Vector3d normal;
    double height;  ///< World units.
    double sigma;   ///< Standard deviation as a fraction of the height.
  };
  /// A range is known roughly from completed depth. See RangeResidual.
  struct Range {
    int pose;
    int point;
    double range;  ///< World units.
    double sigma;  ///< Standard deviation of ln(range).
  };
  /// The distance between two cameras is known. Its residual is that of RangeResidual.
  struct Distance {
    int pose1;
    int pose2;
    double distance;  ///< World units.
    double sigma;     ///< Standard deviation of ln(distance).
  };
  std::vector<Rigid3> world_from_camera;
  /// By pose. At least one pose is fixed, since the gauge is free otherwise.
  std::vector<uint8_t> pose_fixed;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Height> heights;
  std::vector<Range> ranges;
  std::vector<Distance> distances;
};

}  // namespace orb360
