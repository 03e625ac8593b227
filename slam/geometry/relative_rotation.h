#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/geometry/essential_matrix.h"
#include "slam/geometry/ransac.h"

namespace orb360 {

/// Estimates the rotation between two cameras that see the same points without parallax, from unit
/// bearings that correspond by position; some may be wrong. Two-point samples are followed by a
/// robust least-squares fit (Kabsch) to all correspondences. The rotation fits nearly as many
/// correspondences as EstimateRelativePose exactly when the camera did not move or all points are
/// far away.
///
/// The error of a correspondence is the angle between bearing1 and R * bearing2 in standard
/// deviations sqrt(sigma1^2 + sigma2^2). The result's translation is zero.
///
/// Returns nullopt when fewer than options.min_inliers agree. Throws ContractError when sizes
/// differ.
std::optional<RelativePose> EstimateRotation(std::span<const Eigen::Vector3d> bearings1,
                                             std::span<const Eigen::Vector3d> bearings2,
                                             Sigmas sigmas1, Sigmas sigmas2,
                                             const RansacOptions& options = {});
inline std::optional<RelativePose> EstimateRotation(std::span<const Eigen::Vector3d> bearings1,
                                                    std::span<const Eigen::Vector3d> bearings2,
                                                    const RansacOptions& options = {}) {
  return EstimateRotation(bearings1, bearings2, {}, {}, options);
}

}  // namespace orb360
