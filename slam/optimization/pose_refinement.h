#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// One landmark seen in the image whose pose is sought.
struct PoseObservation {
  Eigen::Vector3d point;    // world
  Eigen::Vector3d bearing;  // unit, camera frame
  double sigma;             // angular noise, rad
};

struct RefinedPose {
  Rigid3 world_from_camera;
  std::vector<uint8_t> inliers;  // by observation
  int num_inliers = 0;
  /// Of the inliers' residuals, in sigmas (1 when the noise is as assumed).
  double rms = 0;
};

/// Pose of a camera from landmarks, by Levenberg-Marquardt on tangent-plane residuals
/// (bearing_residual.h) from `initial` on: rounds with a Huber loss in which observations beyond
/// the 95 % bound are set aside, and may come back, then a last one on the inliers alone.
/// With fewer than three inliers the result is `initial` without inliers.
RefinedPose RefinePose(const Rigid3& initial_world_from_camera,
                       std::span<const PoseObservation> observations);

}  // namespace orb360
