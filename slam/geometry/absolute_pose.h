#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/ransac.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Pose of a camera among known points.
struct AbsolutePose {
  Rigid3 camera_from_world;
  std::vector<bool> inliers;  ///< one for each correspondence
  int num_inliers = 0;
};

/// Estimates the pose of a camera from points in the world and the unit bearings at which it sees
/// them. Points and bearings correspond by position; some correspondences may be wrong. Three-point
/// samples (P3P) are followed by a robust least-squares fit of the six parameters to all
/// correspondences. Points may lie in any direction; the range along the bearing must be positive.
///
/// The error of a correspondence is the sine of the angle between the bearing and the direction to
/// the point, in standard deviations `sigmas` (radians in each direction; the points are treated as
/// exact). For relocalization, where most matches may be wrong, use a smaller
/// options.min_inlier_ratio.
///
/// Returns nullopt when fewer than options.min_inliers agree. Throws ContractError when sizes
/// differ.
std::optional<AbsolutePose> EstimateAbsolutePose(std::span<const Eigen::Vector3d> points_world,
                                                 std::span<const Eigen::Vector3d> bearings,
                                                 Sigmas sigmas, const RansacOptions& options = {});
inline std::optional<AbsolutePose> EstimateAbsolutePose(
    std::span<const Eigen::Vector3d> points_world, std::span<const Eigen::Vector3d> bearings,
    const RansacOptions& options = {}) {
  return EstimateAbsolutePose(points_world, bearings, {}, options);
}

}  // namespace orb360
