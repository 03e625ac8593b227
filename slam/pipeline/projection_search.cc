#include "slam/pipeline/projection_search.h"

#include <algorithm>
#include <cmath>

#include "slam/features/hamming.h"

namespace orb360 {
namespace {

// The coarsest level of the pyramid, and the largest difference between the level of a feature and
// the predicted one.
constexpr int kMaxLevel = 7;
constexpr int kLevelTolerance = 1;

}  // namespace

std::optional<int> ExpectLevel(const Eigen::Vector3d& point, const Eigen::Vector3d& usual_direction,
                               double max_range, double min_view_cosine) {
  const double range = point.norm();
  // Beyond `max_range` the landmark would be too small for the finest level; from much nearer it
  // would be too large for the coarsest one.
  const int level = PredictLevel(max_range, range);
  if (!(range > 0) || level < -kLevelTolerance || level > kMaxLevel + kLevelTolerance) {
    return std::nullopt;
  }
  const double aside = min_view_cosine * range * usual_direction.norm();
  if (point.dot(usual_direction) < aside) return std::nullopt;
  return std::clamp(level, 0, kMaxLevel);
}

int FindFeature(const Features& features, const Rigid3& camera_from_world,
                const LocalLandmark& landmark, std::span<const uint8_t> taken,
                const ProjectionSearchOptions& options, std::vector<int>* candidates, int* distance,
                bool* expected) {
  *expected = false;
  const Eigen::Vector3d point = camera_from_world * landmark.position;
  const std::optional<int> level =
      ExpectLevel(point, camera_from_world.rotation * landmark.mean_direction, landmark.max_range,
                  options.min_view_cosine);
  if (!level) return -1;
  *expected = true;

  const double radius =
      options.scale_radius ? options.radius * std::exp2(*level / 4.0) : options.radius;
  const Eigen::Vector3d bearing = point.normalized();
  candidates->clear();
  features.grid.Query(bearing, radius, candidates);
  const double min_cosine = std::cos(radius);
  std::erase_if(*candidates, [&](int i) {
    return std::abs(features.keypoints[i].level - *level) > kLevelTolerance ||
           features.bearings[i].dot(bearing) < min_cosine || (!taken.empty() && taken[i]);
  });
  const NearestTwo nearest = FindNearestTwo(landmark.descriptor, features.descriptors, *candidates);
  *distance = nearest.best_distance;
  if (nearest.best_distance > options.max_distance) return -1;
  const bool rivalled =
      nearest.second_index >= 0 && features.keypoints[nearest.second_index].level ==
                                       features.keypoints[nearest.best_index].level;
  if (rivalled && nearest.best_distance > options.ratio * nearest.second_distance) return -1;
  return nearest.best_index;
}

ProjectionMatches SearchByProjection(const Features& features, const Rigid3& world_from_camera,
                                     std::span<const LocalLandmark> landmarks,
                                     std::span<const uint8_t> taken,
                                     const ProjectionSearchOptions& options) {
  const Rigid3 camera_from_world = world_from_camera.Inverse();
  const int count = static_cast<int>(landmarks.size());
  std::vector<int> feature_of(count, -1);
  std::vector<int> distance_of(count, NearestTwo::kNone);
  ProjectionMatches matches;
  matches.expected.assign(count, 0);
#pragma omp parallel num_threads(options.num_threads)
  {
    std::vector<int> candidates;
#pragma omp for schedule(static)
    for (int i = 0; i < count; ++i) {
      bool expected = false;
      feature_of[i] = FindFeature(features, camera_from_world, landmarks[i], taken, options,
                                  &candidates, &distance_of[i], &expected);
      matches.expected[i] = expected;
    }
  }
  matches.landmark_of_feature.assign(features.size(), -1);
  for (int i = 0; i < count; ++i) {
    if (feature_of[i] < 0) continue;
    int& owner = matches.landmark_of_feature[feature_of[i]];
    if (owner < 0) {
      owner = i;
      ++matches.num_matches;
    } else if (distance_of[i] < distance_of[owner]) {
      owner = i;
    }
  }
  return matches;
}

}  // namespace orb360
