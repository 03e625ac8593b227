#include "slam/pipeline/landmark_fusion.h"

#include <algorithm>
#include <cmath>

#include "slam/features/hamming.h"
#include "slam/optimization/bearing_residual.h"
#include "slam/pipeline/projection_search.h"

namespace orb360 {
namespace {

// Search window among neighbouring keyframes, in standard deviations. It is narrow, because both
// the landmark and the poses have been estimated.
constexpr double kSearchSigmas = 3.0;
constexpr int kMaxDistance = 50;  // differing bits

}  // namespace

std::vector<LandmarkId> LandmarksSeenBy(std::span<const KeyframeId> keyframes, const Map& map) {
  std::vector<LandmarkId> ids;
  for (const KeyframeId id : keyframes) {
    const std::vector<LandmarkId>& seen = map.keyframe(id).landmarks;
    std::copy_if(seen.begin(), seen.end(), std::back_inserter(ids),
                 [](LandmarkId l) { return l != kNoId; });
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

void FuseLandmarks(KeyframeId target, std::span<const LandmarkId> ids, double radius_sigmas,
                   Map* map) {
  const Keyframe& keyframe = map->keyframe(target);
  const Features& features = *keyframe.features;
  if (features.size() == 0) return;
  float min_sigma = features.keypoints[0].sigma;
  for (const Keypoint& keypoint : features.keypoints) {
    min_sigma = std::min(min_sigma, keypoint.sigma);
  }
  const ProjectionSearchOptions search{.radius = radius_sigmas * min_sigma,
                                       .scale_radius = true,
                                       .max_distance = kMaxDistance,
                                       .ratio = 1.0};
  const double max_squared_residual = kChiSquared95 * std::pow(radius_sigmas / kSearchSigmas, 2);
  const Rigid3 camera_from_world = keyframe.world_from_camera.Inverse();
  std::vector<int> candidates;
  for (const LandmarkId id : ids) {
    if (!map->HasLandmark(id)) continue;
    const Landmark& landmark = map->landmark(id);
    if (landmark.FindObservation(target) != nullptr) continue;
    int distance = NearestTwo::kNone;
    bool expected = false;
    const int feature = FindFeature(
        features, camera_from_world,
        {id, landmark.position, landmark.mean_direction, landmark.max_range, landmark.descriptor},
        {}, search, &candidates, &distance, &expected);
    if (feature < 0) continue;
    const Eigen::Vector2d residual = BearingResidual(
        camera_from_world * landmark.position,
        TangentBasis(features.bearings[feature]) / features.keypoints[feature].sigma, nullptr);
    if (residual.squaredNorm() > max_squared_residual) continue;
    const LandmarkId present = map->keyframe(target).landmarks[feature];
    if (present == kNoId) {
      map->AddObservation(id, target, feature);
      map->UpdateAppearance(id);
      continue;
    }
    const bool present_is_better =
        map->landmark(present).observations.size() >= landmark.observations.size();
    const LandmarkId keep = present_is_better ? present : id;
    map->MergeLandmark(present_is_better ? id : present, keep);
    map->UpdateAppearance(keep);
  }
}

void FuseWithNeighbours(KeyframeId id, int max_neighbours, Map* map) {
  std::vector<Map::Covisible> neighbours = map->FindCovisible(map->keyframe(id).landmarks, 1, id);
  if (static_cast<int>(neighbours.size()) > max_neighbours) neighbours.resize(max_neighbours);
  const std::vector<LandmarkId> own = LandmarksSeenBy(std::span(&id, 1), *map);
  std::vector<KeyframeId> others;
  for (const Map::Covisible& neighbour : neighbours) {
    FuseLandmarks(neighbour.keyframe, own, kSearchSigmas, map);
    others.push_back(neighbour.keyframe);
  }
  FuseLandmarks(id, LandmarksSeenBy(others, *map), kSearchSigmas, map);
}

}  // namespace orb360
