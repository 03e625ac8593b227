#pragma once

#include <span>
#include <vector>

#include <orb360/slam/map/map.h>

namespace orb360 {

/// The properties of a landmark that tracking uses.
struct LocalLandmark {
  LandmarkId id;
  Eigen::Vector3d position;        ///< World frame.
  Eigen::Vector3d mean_direction;  ///< As in Landmark.
  double max_range;
  Descriptor descriptor;
};

/// A feature of the reference keyframe that has no landmark, at the position that completed depth
/// gives it (paper III-D). It supports the poses of frames nearby; it becomes a landmark only by
/// triangulation.
struct ProvisionalPoint {
  /// It has no id. Its `position` follows from the completed range.
  LocalLandmark appearance;
  float bearing_sigma;  ///< Angular noise of the reference's feature, rad.
  float range_sigma;    ///< Standard deviation of ln(range) from the reference.
};

/// A copy of the part of the map around a camera. Tracking uses it while a mapping job owns the map
/// itself.
struct LocalMap {
  KeyframeId reference = kNoId;  ///< The keyframe around which it was made.
  Rigid3 world_from_reference;
  /// Median range of the reference's landmarks from the reference, world units.
  double median_range = 0;
  /// Number of the reference's corners that at least two other keyframes see.
  int reference_matches = 0;
  std::vector<LocalLandmark> landmarks;  ///< Ordered by id.
  std::vector<ProvisionalPoint> provisional;

  /// Returns null where the local map does not contain the landmark.
  const LocalLandmark* Find(LandmarkId id) const;
};

/// Returns a point for each feature of a keyframe that has a completed range and no landmark, in
/// the order of the features.
std::vector<ProvisionalPoint> MakeProvisionalPoints(const Keyframe& keyframe);

/// Copies the landmarks of `reference` and of the `num_keyframes` keyframes that share most
/// landmarks with it.
LocalMap MakeLocalMap(const Map& map, KeyframeId reference, int num_keyframes);

}  // namespace orb360
