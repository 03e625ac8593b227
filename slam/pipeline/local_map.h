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

/// The part of the map around a camera, copied out: tracking goes on with it while a mapping job
/// has the map itself.
struct LocalMap {
  KeyframeId reference = kNoId;  // the keyframe it was made around
  Rigid3 world_from_reference;
  double median_range = 0;    // of the reference's landmarks, from the reference
  int reference_matches = 0;  // landmarks of the reference that at least 2 other keyframes see
  std::vector<LocalLandmark> landmarks;  // ordered by id

  /// Null where the local map does not hold it.
  const LocalLandmark* Find(LandmarkId id) const;
};

/// All landmarks of `reference` and of the `num_keyframes` keyframes that share most landmarks
/// with it.
LocalMap MakeLocalMap(const Map& map, KeyframeId reference, int num_keyframes);

}  // namespace orb360
