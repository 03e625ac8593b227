#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// The ground as the steps of some keyframes show it, in the map's unit of length, which is that of
/// the newest one where they differ. Empty where fewer than four fifths of the keyframes have steps
/// that agree on the height of the camera, and fewer than two have steps that add up; the latter
/// counts within the first kGroundSearch keyframes only.
std::optional<KnownGround> GroundFromSteps(const Map& map, std::span<const KeyframeId> keyframes);

/// Whether no step of the keyframes contradicts the height of a ground that something else shows. A
/// plane of landmarks may be anything.
bool AgreesWithSteps(const KnownGround& ground, const Map& map,
                     std::span<const KeyframeId> keyframes);

/// The normal of the ground that the steps of a keyframe show, unit, world frame.
std::optional<Eigen::Vector3d> GroundNormalFromSteps(const Keyframe& keyframe);

}  // namespace orb360
