#include "slam/pipeline/mapper.h"

#include <algorithm>
#include <utility>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/ground.h"
#include "slam/pipeline/ground_steps.h"
#include "slam/pipeline/landmark_fusion.h"
#include "slam/pipeline/observation_alignment.h"
#include "slam/pipeline/panoramic_triangulation.h"
#include "slam/pipeline/patch_search.h"

namespace orb360 {
namespace {

void CullRecentLandmarks(KeyframeId newest, const MapperOptions& options, Map* map) {
  // Ids increase with time, so the landmarks on probation are among the last ones.
  for (LandmarkId id = map->landmark_end() - 1; id >= 0; --id) {
    if (!map->HasLandmark(id)) continue;
    const Landmark& landmark = map->landmark(id);
    const int age = newest - landmark.first_keyframe;
    if (age > options.probation_keyframes + 1) break;
    const bool rarely_found = landmark.found < options.min_found_fraction * landmark.visible;
    const bool not_seen_again =
        age >= options.probation_keyframes && landmark.observations.size() <= 2;
    if (rarely_found || not_seen_again) map->RemoveLandmark(id);
  }
}

// Whether `kOthers` other keyframes see a landmark on the level of this observation or a finer one.
bool IsWellSeenByOthers(const Map& map, const Landmark& landmark, KeyframeId observer, int level) {
  constexpr size_t kOthers = 3;
  if (landmark.observations.size() <= kOthers) return false;
  size_t others = 0;
  for (const Observation& o : landmark.observations) {
    others += o.keyframe != observer &&
              map.keyframe(o.keyframe).features->keypoints[o.feature].level <= level + 1;
    if (others == kOthers) return true;
  }
  return false;
}

// Whether other keyframes see the given fraction of a keyframe's landmarks at least as well.
bool IsRedundant(const Map& map, const Keyframe& keyframe, double fraction) {
  const auto total = static_cast<double>(
      std::ranges::count_if(keyframe.landmarks, [](LandmarkId l) { return l != kNoId; }));
  const double allowed = total - fraction * total;
  int missed = 0;
  for (size_t f = 0; f < keyframe.landmarks.size() && missed <= allowed; ++f) {
    const LandmarkId id = keyframe.landmarks[f];
    if (id == kNoId) continue;
    missed += !IsWellSeenByOthers(map, map.landmark(id), keyframe.id,
                                  keyframe.features->keypoints[f].level);
  }
  return missed <= allowed;
}

void CullRedundantKeyframes(KeyframeId newest, const MapperOptions& options, Map* map) {
  // Something that all keyframes see, such as a cloud, does not make them neighbours.
  constexpr int kMinShared = 15;
  const KeyframeId first = map->KeyframeIds().front();  // It fixes the gauge.
  for (const Map::Covisible& neighbour :
       map->FindCovisible(map->keyframe(newest).landmarks, kMinShared, newest)) {
    const Keyframe& keyframe = map->keyframe(neighbour.keyframe);
    if (keyframe.id == first || !IsRedundant(*map, keyframe, options.redundant_fraction)) continue;
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

KeyframeId IntegrateKeyframe(const TrackedFrame& frame, std::shared_ptr<const SpherePyramid> image,
                             const MapperOptions& options, const std::optional<KnownGround>& ground,
                             const std::optional<cv::Mat>& ground_mask, Map* map) {
  const bool seeks_ground = ground_mask && SeeksGround(*map, ground.has_value());
  const KeyframeId id =
      map->AddKeyframe(frame.index, frame.timestamp, frame.world_from_camera, frame.features);
  for (size_t f = 0; f < frame.landmarks.size(); ++f) {
    const LandmarkId landmark = frame.landmarks[f];
    if (landmark == kNoId) continue;
    // Two landmarks of the frame may have been fused since it was tracked.
    const std::vector<Observation>& observations = map->landmark(landmark).observations;
    if (!observations.empty() && observations.back().keyframe == id) continue;
    map->AddObservation(landmark, id, static_cast<int>(f));
    map->UpdateAppearance(landmark);
  }
  map->keyframe(id).image = std::move(image);
  if (ground_mask) MeasureGroundSteps(id, ground, *ground_mask, map);
  if (ground) CorrectStep(id, *ground, map);
  CullRecentLandmarks(id, options, map);
  TriangulateNewLandmarks(id, options.triangulation, map);
  if (ground) RemoveBelowGround(id, *ground, map);
  FuseWithNeighbours(id, options.max_fusion_neighbours, map);
  AlignObservations(id, ground, map);
  FindByPatches(id, options.max_fusion_neighbours, map);
  AdjustLocally(id, options.bundle, ground, map);
  if (!seeks_ground) CullRedundantKeyframes(id, options, map);
  map->ForgetImages(options.kept_images);
  return id;
}

}  // namespace orb360
