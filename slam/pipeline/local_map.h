#pragma once

#include <span>
#include <vector>

#include "slam/map/map.h"

namespace orb360 {

/// What tracking needs to know of a landmark.
struct LocalLandmark {
  LandmarkId id;
  Eigen::Vector3d position;        // world
  Eigen::Vector3d mean_direction;  // see Landmark
  double max_range;
  Descriptor descriptor;
};

/// A feature of the reference keyframe that has no landmark, where completed depth puts it (paper
/// III-D). Good for the pose of a frame nearby; it becomes a landmark only by triangulation.
struct ProvisionalPoint {
  LocalLandmark appearance;  // without an id; `position` is where it probably is
  float bearing_sigma;       // angular noise of the reference's feature, rad
  float range_sigma;         // standard deviation of ln(range) from the reference
};

/// The part of the map around a camera, copied out: tracking goes on with it while a mapping job
/// has the map itself.
struct LocalMap {
  KeyframeId reference = kNoId;  // the keyframe it was made around
  Rigid3 world_from_reference;
  double median_range = 0;    // of the reference's landmarks, from the reference
  int reference_matches = 0;  // corners of the reference that at least 2 other keyframes see
  std::vector<LocalLandmark> landmarks;  // ordered by id
  std::vector<ProvisionalPoint> provisional;

  /// Null where the local map does not hold it.
  const LocalLandmark* Find(LandmarkId id) const;
};

/// Of a keyframe's features without a landmark whose range is known, in their order.
std::vector<ProvisionalPoint> MakeProvisionalPoints(const Keyframe& keyframe);

/// All landmarks of `reference` and of the `num_keyframes` keyframes that share most landmarks
/// with it.
LocalMap MakeLocalMap(const Map& map, KeyframeId reference, int num_keyframes);

}  // namespace orb360
