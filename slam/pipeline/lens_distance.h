#pragma once

#include <span>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// What all steps over the ground in some maps tell of the distance between the lenses.
struct EstimatedLensDistance {
  LensDistance distance;
  /// Whether there is such a distance beyond doubt. Otherwise steps are measured without it: a
  /// camera with one lens, or whose software has joined the images at the ground, must not be
  /// changed.
  bool is_certain = false;
};

EstimatedLensDistance EstimateLensDistance(std::span<const Map> maps);

/// The distance between the lenses that the next step of a map assumes, heights of the camera: that
/// of its last one.
double AssumedLensDistance(const Map& map);

/// The ratio of a step to the camera's height, with another distance between the lenses than the
/// one that was assumed.
inline double RatioWith(double lens_distance, const GroundStepFrom& step) {
  return step.ratio + step.per_lens_distance * (lens_distance - step.assumed_lens_distance);
}

/// Measures the steps of a map anew with the distance between the lenses that all steps together
/// tell, those of finished maps as well, if it is certain and differs from what was assumed.
/// Returns the factor by which the steps have become longer, so that a map which was made with them
/// has to be enlarged by it; 1 where nothing has changed, and where keyframes of an earlier run
/// hold the unit of length.
double CorrectForLenses(std::span<const Map> finished, Map* map);

}  // namespace orb360
