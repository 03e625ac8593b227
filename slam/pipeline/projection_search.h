#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/pipeline/local_map.h"
#include <orb360/slam/features/features.h>
#include <orb360/slam/geometry/rigid3.h>

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
  /// By feature: index into the landmarks, or -1.
  std::vector<int> landmark_of_feature;
  /// By landmark: whether it should be visible from the pose, judged by range and direction.
  std::vector<uint8_t> expected;
  int num_matches = 0;
};

/// Matches landmarks with features near their predicted positions, on the predicted pyramid level
/// or a level next to it. Features that `taken` (by feature; may be empty) marks are not matched. A
/// feature that matches several landmarks is given to the one with the nearest descriptor.
ProjectionMatches SearchByProjection(const Features& features, const Rigid3& world_from_camera,
                                     std::span<const LocalLandmark> landmarks,
                                     std::span<const uint8_t> taken,
                                     const ProjectionSearchOptions& options);

/// Returns the pyramid level, clamped to the existing ones, on which an image shows a landmark at
/// `point` (camera frame), which other keyframes see along `usual_direction` and at ranges up to
/// `max_range` (Landmark). Empty where the landmark should not be visible, because it is too far
/// away, too near, or seen from a direction that differs too much.
std::optional<int> ExpectLevel(const Eigen::Vector3d& point, const Eigen::Vector3d& usual_direction,
                               double max_range, double min_view_cosine);

/// Does the same search for a single landmark and returns the matching feature, or -1. `candidates`
/// is scratch memory.
int FindFeature(const Features& features, const Rigid3& camera_from_world,
                const LocalLandmark& landmark, std::span<const uint8_t> taken,
                const ProjectionSearchOptions& options, std::vector<int>* candidates, int* distance,
                bool* expected);

}  // namespace orb360
