#include "slam/features/feature_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace orb360 {
namespace {

// Returns the nearest feature on the next finer level, or `feature` itself if there is none.
int FinerCopy(const Features& features, int feature, std::vector<int>* nearby) {
  constexpr double kMaxSigmas = 2.0;
  const Keypoint& keypoint = features.keypoints[feature];
  const Eigen::Vector3d& bearing = features.bearings[feature];
  const double radius = kMaxSigmas * keypoint.sigma;
  nearby->clear();
  features.grid.Query(bearing, radius, nearby);
  double nearest = std::cos(radius);
  int copy = feature;
  for (const int other : *nearby) {
    if (features.keypoints[other].level + 1 != keypoint.level) continue;
    const double cosine = bearing.dot(features.bearings[other]);
    if (cosine <= nearest) continue;
    nearest = cosine;
    copy = other;
  }
  return copy;
}

}  // namespace

void IndexFeatures(Features* features) {
  const auto num_corners = std::ranges::find_if_not(features->keypoints, &Keypoint::is_corner) -
                           features->keypoints.begin();
  features->grid = SphereGrid(std::span(features->bearings).first(num_corners));
  features->corners.resize(features->size());
  std::iota(features->corners.begin(), features->corners.end(), 0);
  std::vector<int> by_level(num_corners);
  std::iota(by_level.begin(), by_level.end(), 0);
  std::stable_sort(by_level.begin(), by_level.end(), [&](int a, int b) {
    return features->keypoints[a].level < features->keypoints[b].level;
  });
  std::vector<int> nearby;
  for (const int feature : by_level) {
    const int copy = FinerCopy(*features, feature, &nearby);
    features->corners[feature] = copy == feature ? feature : features->corners[copy];
  }
}

}  // namespace orb360
