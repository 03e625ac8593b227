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
  /// Two cameras see the same point, whose position relative to each of them is known in some
  /// directions. See SharedPointResidual.
  struct SharedPoint {
    int pose1;
    int pose2;
    Eigen::Vector3d point1;  ///< The point in the frame of camera 1, world units.
    Eigen::Vector3d point2;  ///< The same in the frame of camera 2.
    /// Times the difference of both, frame of camera 2: two values of unit variance.
    Eigen::Matrix<double, 2, 3> sqrt_information;
  };
  std::vector<Rigid3> world_from_camera;
  /// By pose. At least one pose is fixed, since the gauge is free otherwise.
  std::vector<uint8_t> pose_fixed;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Height> heights;
  std::vector<Range> ranges;
  std::vector<SharedPoint> shared_points;
};

}  // namespace orb360
