#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// A landmark that the image whose pose is sought shows.
struct PoseObservation {
  Eigen::Vector3d point;    ///< World frame.
  Eigen::Vector3d bearing;  ///< Unit, camera frame.
  double sigma;             ///< Angular noise, rad.
};

/// What is known of the camera's position before its image is looked at.
struct PositionPrior {
  Eigen::Vector3d position;          ///< World frame.
  Eigen::Matrix3d sqrt_information;  ///< Times the error of the position: of unit covariance.

  /// The error of a position, in standard deviations.
  Eigen::Vector3d ErrorOf(const Eigen::Vector3d& actual) const {
    return sqrt_information * (actual - position);
  }
};

/// 95 % bound of the squared error of a prior, which has a chi-squared distribution with three
/// degrees of freedom.
inline constexpr double kPriorChiSquared95 = 7.815;

struct RefinedPose {
  Rigid3 world_from_camera;
  std::vector<uint8_t> inliers;  ///< By observation.
  int num_inliers = 0;
  /// Number of independent observations that would weigh as much as the inliers (ClusterWeights).
  double support = 0;
  /// The same as a fraction of the number for all observations.
  double inlier_ratio = 0;
  /// Root mean square of the inliers' residuals in sigmas (1 when the noise is as assumed).
  double rms = 0;
};

/// Estimates the pose of a camera from landmarks by Levenberg-Marquardt on tangent-plane residuals
/// (bearing_residual.h) with a Huber loss, starting from `initial_world_from_camera`. Observations
/// close to each other share their weight (ClusterWeights), so that an object with many corners
/// that moves with the camera does not outvote the surroundings. It runs in rounds: after each,
/// observations beyond the 95 % bound are left out of the next, and those within it come back. With
/// fewer than three inliers it returns the initial pose without inliers.
RefinedPose RefinePose(const Rigid3& initial_world_from_camera,
                       std::span<const PoseObservation> observations,
                       const std::optional<PositionPrior>& prior = std::nullopt);

}  // namespace orb360
