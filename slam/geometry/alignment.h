#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Returns target_from_source with the least sum of squared distances |target_from_source *
/// source[i] - target[i]|^2 (Umeyama, Least-Squares Estimation of Transformation Parameters Between
/// Two Point Patterns, PAMI 1991). Points correspond by position; metres.
///
/// Points on one line, such as the path of a car that drives straight, do not determine the
/// rotation about the line, and neither do two points. The result is then the least-squares
/// solution with the smallest rotation angle, so aligned frames stay aligned. If the source or the
/// target is a single place, the rotation is the identity. Returns nullopt without points or if a
/// coordinate is not finite. Throws ContractError when sizes differ.
std::optional<Rigid3> AlignRigid(std::span<const Eigen::Vector3d> source,
                                 std::span<const Eigen::Vector3d> target);

/// As AlignRigid, with a scale, and with a positive weight for each squared distance unless
/// `weights` is empty. Also returns nullopt if there is no positive scale because the source or the
/// target is a single place.
std::optional<Similarity3> AlignSimilarity(std::span<const Eigen::Vector3d> source,
                                           std::span<const Eigen::Vector3d> target,
                                           std::span<const double> weights = {});

}  // namespace orb360
