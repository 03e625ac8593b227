#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "slam/optimization/local_bundle_adjustment.h"
#include <orb360/slam/map/map.h>

namespace orb360 {

/// What one keyframe shows of the ground: its normal, unit, world frame, and the camera's height
/// over it, world units.
struct GroundSighting {
  Eigen::Vector3d up;
  double height;
};

/// Returns the mean normal and the median height of sightings, without those whose height differs
/// by more than a tenth. Empty where fewer than `min_agreeing` remain.
std::optional<KnownGround> AgreeOnGround(std::span<const GroundSighting> sightings,
                                         double min_agreeing);

/// Estimates the ground under some keyframes from the landmarks below them: its mean normal and the
/// median height of the cameras above it. The camera may be tilted by up to 45 degrees. Empty where
/// most keyframes show no ground, or ground at another height.
std::optional<KnownGround> EstimateGround(const Map& map, std::span<const KeyframeId> keyframes);

/// Returns what the landmarks around a keyframe show of the ground, with its normal within 15
/// degrees of `up`. Empty where no such ground is found.
std::optional<GroundSighting> GroundAt(const Map& map, KeyframeId keyframe,
                                       const Eigen::Vector3d& up);

/// Removes the landmarks of a keyframe that lie far below the ground. There is nothing to see: they
/// are corners of something that moves with the camera, such as a car on the next lane, which has
/// as little parallax as something far away.
void RemoveBelowGround(KeyframeId id, const KnownGround& ground, Map* map);

}  // namespace orb360
