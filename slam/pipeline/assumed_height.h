#pragma once

#include <optional>
#include <span>

#include <orb360/slam/map/ground.h>
#include <orb360/slam/map/map.h>

namespace orb360 {

/// How far the surroundings rise above the ground, in heights of the camera: the 90 % quantile over
/// the landmarks within 30 heights of a keyframe that observes them. 0 where fewer than 100 tell.
double RiseOfSurroundings(std::span<const Map> maps,
                          std::span<const std::optional<KnownGround>> grounds);

/// Standard deviation of ln(height of the camera) around ScaleOptions::kAssumedHeight where nobody
/// gave that height. Nearly all cameras are carried by a vehicle or a person. Few are on drones, at
/// any height, and then the surroundings rise less far above the ground in heights of the camera.
/// `rise`: RiseOfSurroundings.
double AssumedHeightSigma(double rise);

}  // namespace orb360
