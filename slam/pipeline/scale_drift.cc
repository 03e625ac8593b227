#include "slam/pipeline/scale_drift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/bearing.h"
#include "slam/geometry/cluster_weights.h"

namespace orb360 {
namespace {

constexpr double kLargestDrift = 1.0;  // where nothing passes the scale on

}  // namespace

double DriftVariance(const Map& map, KeyframeId first, KeyframeId second, KeyframeId third) {
  const Keyframe& newest = map.keyframe(third);
  const Eigen::Vector3d& center1 = map.keyframe(first).world_from_camera.translation;
  const Eigen::Vector3d& center2 = map.keyframe(second).world_from_camera.translation;
  const Eigen::Vector3d& center3 = newest.world_from_camera.translation;
  std::vector<Eigen::Vector3d> bearings;
  std::vector<double> informations;
  for (size_t f = 0; f < newest.landmarks.size(); ++f) {
    if (newest.landmarks[f] == kNoId) continue;
    const Landmark& landmark = map.landmark(newest.landmarks[f]);
    if (landmark.FindObservation(first) == nullptr || landmark.FindObservation(second) == nullptr) {
      continue;
    }
    const double parallax1 = AngleBetween(landmark.position - center1, landmark.position - center2);
    const double parallax2 = AngleBetween(landmark.position - center2, landmark.position - center3);
    const double noise = newest.features->keypoints[f].sigma;
    const double product = parallax1 * parallax2;
    informations.push_back(product * product /
                           (noise * noise * (parallax1 * parallax1 + parallax2 * parallax2)));
    bearings.push_back(newest.features->bearings[f]);
  }
  const std::vector<double> weights =
      ClusterWeights(bearings).Weights(std::vector<uint8_t>(bearings.size(), 1));
  double information = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (std::isfinite(informations[i])) information += weights[i] * informations[i];
  }
  return std::clamp(1 / std::max(information, 1e-12), kLeastDrift, kLargestDrift);
}

}  // namespace orb360
