#include "slam/pipeline/mapper.h"

#include <algorithm>
#include <utility>

#include "slam/pipeline/landmark_fusion.h"
#include "slam/pipeline/observation_alignment.h"
#include "slam/pipeline/patch_search.h"

namespace orb360 {
namespace {

void CullRecentLandmarks(KeyframeId newest, const MapperOptions& options, Map* map) {
  // Ids grow with time: landmarks on probation are among the last ones.
  for (LandmarkId id = map->landmark_end() - 1; id >= 0; --id) {
    if (!map->HasLandmark(id)) continue;
    const Landmark& landmark = map->landmark(id);
    const int age = newest - landmark.first_keyframe;
    if (age > options.probation_keyframes + 1) break;
    const bool rarely_found = landmark.found < options.min_found_share * landmark.visible;
    const bool not_seen_again =
        age >= options.probation_keyframes && landmark.observations.size() <= 2;
    if (rarely_found || not_seen_again) map->RemoveLandmark(id);
  }
}

// Share of a keyframe's landmarks that at least three others see on the same level or a finer one.
double RedundantShare(const Map& map, const Keyframe& keyframe) {
  constexpr size_t kOthers = 3;
  int total = 0;
  int redundant = 0;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    const LandmarkId id = keyframe.landmarks[f];
    if (id == kNoId) continue;
    ++total;
    const std::vector<Observation>& observations = map.landmark(id).observations;
    if (observations.size() <= kOthers) continue;
    const int level = keyframe.features->keypoints[f].level;
    size_t others = 0;
    for (const Observation& o : observations) {
      others += o.keyframe != keyframe.id &&
                map.keyframe(o.keyframe).features->keypoints[o.feature].level <= level + 1;
    }
    redundant += others >= kOthers;
  }
  return total == 0 ? 1.0 : redundant / static_cast<double>(total);
}

void CullRedundantKeyframes(KeyframeId newest, const MapperOptions& options, Map* map) {
  const KeyframeId first = map->KeyframeIds().front();  // the gauge
  for (const Map::Covisible& neighbour :
       map->FindCovisible(map->keyframe(newest).landmarks, 1, newest)) {
    const Keyframe& keyframe = map->keyframe(neighbour.keyframe);
    if (keyframe.id == first || RedundantShare(*map, keyframe) < options.redundant_share) continue;
    const std::vector<LandmarkId> landmarks = keyframe.landmarks;
    const std::vector<Map::Covisible> nearest =
        map->FindCovisible(keyframe.landmarks, 1, keyframe.id);
    map->RemoveKeyframe(keyframe.id, nearest.empty() ? first : nearest.front().keyframe);
    for (const LandmarkId id : landmarks) {
      if (id != kNoId && map->landmark(id).observations.size() < 2) map->RemoveLandmark(id);
    }
  }
}

}  // namespace

KeyframeId IntegrateKeyframe(const TrackedFrame& frame,
                             std::shared_ptr<const SpherePyramid> picture,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             Map* map) {
  const KeyframeId id =
      map->AddKeyframe(frame.index, frame.timestamp, frame.world_from_camera, frame.features);
  for (size_t f = 0; f < frame.landmarks.size(); ++f) {
    const LandmarkId landmark = frame.landmarks[f];
    if (landmark == kNoId) continue;
    // Two landmarks of the frame may have become one since it was tracked.
    const std::vector<Observation>& observations = map->landmark(landmark).observations;
    if (!observations.empty() && observations.back().keyframe == id) continue;
    map->AddObservation(landmark, id, static_cast<int>(f));
    map->UpdateAppearance(landmark);
  }
  map->keyframe(id).picture = std::move(picture);
  CullRecentLandmarks(id, options, map);
  TriangulateNewLandmarks(id, options.triangulation, map);
  FuseWithNeighbours(id, options.max_fusion_neighbours, map);
  AlignObservations(id, ground, map);
  FindByPatches(id, options.max_fusion_neighbours, map);
  AdjustLocally(id, options.bundle, ground, map);
  CullRedundantKeyframes(id, options, map);
  map->ForgetPictures(options.kept_pictures);
  return id;
}

}  // namespace orb360
