#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"

namespace orb360 {

/// The ground under some keyframes, from the landmarks below them: its mean normal, and the median
/// height of the cameras over it. The camera may be tilted by up to 45 degrees. Empty where most
/// keyframes have no ground, or one at another height.
std::optional<KnownGround> EstimateGround(const Map& map, std::span<const KeyframeId> keyframes);

/// Normal of the ground around a keyframe, unit, world; within 15 degrees of `up`.
std::optional<Eigen::Vector3d> GroundNormal(const Map& map, KeyframeId keyframe,
                                            const Eigen::Vector3d& up);

}  // namespace orb360
