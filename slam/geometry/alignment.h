#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/geometry/rigid3.h"

namespace orb360 {

/// target_from_source with the least sum of squared distances |target_from_source * source[i] -
/// target[i]|^2 (Umeyama, Least-Squares Estimation of Transformation Parameters Between Two Point
/// Patterns, PAMI 1991), points at equal positions in metres.
///
/// Points on one line, such as the path of a car that drives straight, leave the turn about the
/// line open; so do two points. The result is then still a least-squares one, namely the one whose
/// rotation is by the smallest angle: aligned frames stay aligned. Empty without points, or
/// where a coordinate is not finite. If the source or the target is a single place the rotation is
/// the identity. Throws ContractError when sizes differ.
std::optional<Rigid3> AlignRigid(std::span<const Eigen::Vector3d> source,
                                 std::span<const Eigen::Vector3d> target);

/// As AlignRigid, with a scale. Empty too where there is no positive one: the source or the target
/// is a single place.
std::optional<Similarity3> AlignSimilarity(std::span<const Eigen::Vector3d> source,
                                           std::span<const Eigen::Vector3d> target);

}  // namespace orb360
