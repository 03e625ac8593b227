#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry/ransac.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

/// Where a camera stands among known points.
struct AbsolutePose {
  Rigid3 camera_from_world;
  std::vector<bool> inliers;  ///< one for each correspondence
  int num_inliers = 0;
};

/// Pose of a camera from points in the world and the unit bearings at which it sees them, at equal
/// positions, some of them wrong: three-point samples (P3P), then a robust least-squares fit of the
/// six parameters to all correspondences. Points lie in any direction; behind the camera is as
/// good as in front, and only the side of the bearing counts.
///
/// The error of a correspondence is the angle (its sine) between the bearing and the direction to
/// the point, in standard deviations `sigmas` (radians in each direction; the points count as
/// exact). For relocalization, where most matches may be wrong, lower options.min_inlier_share.
///
/// Empty when fewer than options.min_inliers agree. Throws ContractError when sizes differ.
std::optional<AbsolutePose> EstimateAbsolutePose(std::span<const Eigen::Vector3d> points_world,
                                                 std::span<const Eigen::Vector3d> bearings,
                                                 Sigmas sigmas, const RansacOptions& options = {});
inline std::optional<AbsolutePose> EstimateAbsolutePose(
    std::span<const Eigen::Vector3d> points_world, std::span<const Eigen::Vector3d> bearings,
    const RansacOptions& options = {}) {
  return EstimateAbsolutePose(points_world, bearings, {}, options);
}

}  // namespace orb360
