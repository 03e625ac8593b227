#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/features/features.h"
#include "slam/geometry/rigid3.h"
#include "slam/pipeline/local_map.h"

namespace orb360 {

struct ProjectionSearchOptions {
  /// Search window: angle, radians, on pyramid level 0 ...
  double radius = 0.05;
  /// ... that grows with the predicted level's scale if this is set: a matter of noise, not of an
  /// unknown motion.
  bool scale_radius = false;
  int max_distance = 64;  // differing bits
  double ratio = 0.9;     // against a second best of the same pyramid level
  /// Landmarks seen from more than this angle (cosine) beside their usual direction are skipped.
  double min_view_cosine = 0.5;
  int num_threads = 1;  // of OpenMP; the result does not depend on it
};

struct ProjectionMatches {
  /// By feature: index into the landmarks, -1 where none.
  std::vector<int> landmark_of_feature;
  /// By landmark: whether it should be visible from the pose, by range and direction.
  std::vector<uint8_t> expected;
  int num_matches = 0;
};

/// Matches landmarks to features near to where the pose predicts them, on the predicted pyramid
/// level or next to it. Features with `taken` set (by feature; may be empty) are left alone; where
/// several landmarks want one feature the nearest descriptor gets it.
ProjectionMatches SearchByProjection(const Features& features, const Rigid3& world_from_camera,
                                     std::span<const LocalLandmark> landmarks,
                                     std::span<const uint8_t> taken,
                                     const ProjectionSearchOptions& options);

/// The pyramid level on which an image shows what lies at `point`, in the camera's frame, and is
/// seen by others along `usual_direction` and up to `max_range` (Landmark), clamped. Empty where it
/// should not be visible: too far away, too near, or from too far beside.
std::optional<int> ExpectLevel(const Eigen::Vector3d& point, const Eigen::Vector3d& usual_direction,
                               double max_range, double min_view_cosine);

/// The feature that best shows a landmark, -1 if none: the search above for a single landmark.
/// `candidates` is scratch memory.
int FindFeature(const Features& features, const Rigid3& camera_from_world,
                const LocalLandmark& landmark, std::span<const uint8_t> taken,
                const ProjectionSearchOptions& options, std::vector<int>* candidates, int* distance,
                bool* expected);

}  // namespace orb360
