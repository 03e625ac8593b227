#include "slam/pipeline/local_map.h"

#include <algorithm>

namespace orb360 {

std::vector<ProvisionalPoint> MakeProvisionalPoints(const Keyframe& keyframe) {
  std::vector<ProvisionalPoint> points;
  const Features& features = *keyframe.features;
  const std::vector<uint8_t> is_mapped = FindMappedCorners(keyframe);
  for (int f = 0; f < features.size(); ++f) {
    const RangePrior prior = keyframe.PriorOf(f);
    if (prior.sigma == 0 || is_mapped[features.corners[f]]) continue;
    const Keypoint& keypoint = features.keypoints[f];
    if (!keypoint.is_corner()) continue;
    const Eigen::Vector3d direction = keyframe.world_from_camera.rotation * features.bearings[f];
    const Eigen::Vector3d position =
        keyframe.world_from_camera.translation + prior.range * direction;
    points.push_back({{kNoId, position, direction, RangeAtLevelZero(prior.range, keypoint.level),
                       features.descriptors[f]},
                      keypoint.sigma,
                      prior.sigma});
  }
  return points;
}

const LocalLandmark* LocalMap::Find(LandmarkId id) const {
  const auto place =
      std::lower_bound(landmarks.begin(), landmarks.end(), id,
                       [](const LocalLandmark& l, LandmarkId i) { return l.id < i; });
  return place != landmarks.end() && place->id == id ? &*place : nullptr;
}

LocalMap MakeLocalMap(const Map& map, KeyframeId reference, int num_keyframes) {
  const Keyframe& center = map.keyframe(reference);
  LocalMap local;
  local.reference = reference;
  local.world_from_reference = center.world_from_camera;

  std::vector<Map::Covisible> neighbours = map.FindCovisible(center.landmarks, 1, reference);
  if (static_cast<int>(neighbours.size()) > num_keyframes) neighbours.resize(num_keyframes);
  std::vector<LandmarkId> ids = center.landmarks;
  for (const Map::Covisible& neighbour : neighbours) {
    const std::vector<LandmarkId>& seen = map.keyframe(neighbour.keyframe).landmarks;
    ids.insert(ids.end(), seen.begin(), seen.end());
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  local.landmarks.reserve(ids.size());
  for (const LandmarkId id : ids) {
    if (id == kNoId) continue;
    const Landmark& l = map.landmark(id);
    local.landmarks.push_back({id, l.position, l.mean_direction, l.max_range, l.descriptor});
  }

  for (size_t f = 0; f < center.landmarks.size(); ++f) {
    const LandmarkId id = center.landmarks[f];
    if (id == kNoId || !center.features->keypoints[f].is_corner()) continue;
    local.reference_matches += map.landmark(id).observations.size() >= 3;
  }
  local.median_range = map.MedianRange(reference);
  local.provisional = MakeProvisionalPoints(center);
  return local;
}

}  // namespace orb360
