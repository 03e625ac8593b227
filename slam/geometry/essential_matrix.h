#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/geometry/ransac.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Returns E_12 = [t_12]x R_12 (paper Eq. 5), so that bearing1^T E_12 bearing2 = 0 for every point.
inline Eigen::Matrix3d EssentialMatrix(const Rigid3& camera1_from_camera2) {
  return Skew(camera1_from_camera2.translation) * camera1_from_camera2.rotation.toRotationMatrix();
}

/// Returns the unit normal, in camera 2, of the epipolar plane of a bearing in camera 1 (paper Eq.
/// 6): E_12^T bearing1. Returns zero where there is no plane: at the epipole and without a
/// baseline.
inline Eigen::Vector3d EpipolarPlaneNormal(const Eigen::Matrix3d& essential,
                                           const Eigen::Vector3d& bearing1) {
  const Eigen::Vector3d normal = essential.transpose() * bearing1;
  return normal.normalized();
}

/// Returns the angle in radians, in [0, pi/2], between a unit bearing and the plane with that unit
/// normal. Eq. 7 is the square of its sine. Compare it with a multiple of the feature's angular
/// noise.
inline double AngleToPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& bearing) {
  return std::asin(std::min(1.0, std::abs(normal.dot(bearing))));
}

/// Returns the unit direction of the centre of camera 1 in camera 2.
inline Eigen::Vector3d EpipoleInCamera2(const Rigid3& camera1_from_camera2) {
  return camera1_from_camera2.Inverse().translation.normalized();
}

/// Returns true if a bearing is far enough from the epipole and its antipode to have parallax:
/// |e.p| < mu. `max_cosine` is mu, the cosine of the smallest angle. (The paper prints the opposite
/// sign.)
inline bool IsAwayFromEpipole(const Eigen::Vector3d& epipole, const Eigen::Vector3d& bearing,
                              double max_cosine) {
  return std::abs(epipole.dot(bearing)) < max_cosine;
}

/// Relative pose of two cameras that see the same unknown points.
struct RelativePose {
  Rigid3 camera1_from_camera2;  ///< translation of unit length, or zero from EstimateRotation
  std::vector<bool> inliers;    ///< one for each correspondence
  int num_inliers = 0;
};

/// Estimates the relative pose from unit bearings of the same points in two cameras.
/// Correspondences are given by position, and up to 60 % of them may be wrong. Five-point samples
/// with cheirality by positive range (any hemisphere) are followed by a robust least-squares fit of
/// the five parameters to all correspondences.
///
/// The error of a correspondence is its angle to the epipolar geometry, distributed over both
/// bearings: |b1.(t x R b2)| / sqrt(sigma1^2 |t x R b2|^2 + sigma2^2 |t x b1|^2) standard
/// deviations. Where the rays would meet behind a camera it is the angle between them, so that far
/// points stay inliers. If the camera only turned, the direction of the translation is meaningless;
/// the rays then meet at angles of the order of the noise.
///
/// Returns nullopt when fewer than options.min_inliers agree. Throws ContractError when sizes
/// differ.
std::optional<RelativePose> EstimateRelativePose(std::span<const Eigen::Vector3d> bearings1,
                                                 std::span<const Eigen::Vector3d> bearings2,
                                                 Sigmas sigmas1, Sigmas sigmas2,
                                                 const RansacOptions& options = {});
inline std::optional<RelativePose> EstimateRelativePose(std::span<const Eigen::Vector3d> bearings1,
                                                        std::span<const Eigen::Vector3d> bearings2,
                                                        const RansacOptions& options = {}) {
  return EstimateRelativePose(bearings1, bearings2, {}, {}, options);
}

}  // namespace orb360
