#pragma once

#include <orb360/slam/map/map.h>

namespace orb360 {

/// Least variance of the scale between two keyframes.
inline constexpr double kLeastDrift = 1e-6;

/// Variance of ln(scale) with which landmarks pass the scale on from the step between two keyframes
/// to the next step: a landmark whose range the first step has shown tells the length of the second
/// one. It is 1 where no landmark does.
double DriftVariance(const Map& map, KeyframeId first, KeyframeId second, KeyframeId third);

}  // namespace orb360
