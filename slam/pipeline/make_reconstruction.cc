#include "slam/pipeline/make_reconstruction.h"

#include <algorithm>

#include "slam/map/covisibility.h"
#include "slam/pipeline/ground.h"
#include "slam/pipeline/trajectory_interpolation.h"

namespace orb360 {

namespace {

int FrameOfReference(const Map& map, KeyframeId reference) {
  return map.keyframe(map.LivingKeyframe(reference)).frame_index;
}

}  // namespace

Reconstruction MakeReconstruction(std::span<const Map> maps, const FrameAnchors& anchors,
                                  int num_threads) {
  Reconstruction result;
  result.maps.resize(maps.size());
  std::vector<const FrameAnchor*> ordered;
  for (const auto& [index, anchor] : anchors) {
    result.frames.push_back({.index = index,
                             .timestamp = anchor.timestamp,
                             .map = anchor.map,
                             .world_from_camera = {},
                             .is_interpolated = anchor.is_interpolated,
                             .reference = FrameOfReference(maps[anchor.map], anchor.reference)});
    ordered.push_back(&anchor);
    result.interpolated += anchor.is_interpolated;
    MapSummary& summary = result.maps[anchor.map];
    if (summary.tracked++ == 0) summary.first_frame = index;
    summary.last_frame = index;
  }
  const std::vector<TrajectoryInterpolation> paths(maps.begin(), maps.end());
#pragma omp parallel for schedule(dynamic, 16) num_threads(num_threads)
  for (size_t i = 0; i < ordered.size(); ++i) {
    const FrameAnchor& anchor = *ordered[i];
    const Map& map = maps[anchor.map];
    result.frames[i].world_from_camera =
        RefineFrame(map, map.PoseOf(anchor.reference) * anchor.reference_from_camera,
                    anchor.sightings, paths[anchor.map].PositionAt(anchor.timestamp));
  }
  int64_t num_matched = 0;
  int64_t num_seen = 0;
  for (size_t m = 0; m < maps.size(); ++m) {
    const Map& map = maps[m];
    result.maps[m].keyframes = map.num_keyframes();
    result.maps[m].landmarks = map.num_landmarks();
    for (const KeyframeId id : map.KeyframeIds()) {
      const Keyframe& keyframe = map.keyframe(id);
      result.keyframes.push_back({.index = keyframe.frame_index,
                                  .timestamp = keyframe.timestamp,
                                  .map = static_cast<int>(m),
                                  .world_from_camera = keyframe.world_from_camera,
                                  .reference = keyframe.frame_index});
      const std::vector<uint8_t> is_mapped = FindMappedCorners(keyframe);
      for (int f = 0; f < keyframe.features->size(); ++f) {
        num_matched += keyframe.features->keypoints[f].is_corner() &&
                       is_mapped[keyframe.features->corners[f]] != 0;
      }
      num_seen +=
          std::ranges::count_if(keyframe.landmarks, [](LandmarkId l) { return l != kNoId; });
    }
    for (LandmarkId id = 0; id < map.landmark_end(); ++id) {
      if (!map.HasLandmark(id)) continue;
      result.landmarks.push_back({map.landmark(id).position, map.landmark(id).color});
    }
  }
  std::sort(result.keyframes.begin(), result.keyframes.end(),
            [](const FramePose& a, const FramePose& b) { return a.index < b.index; });
  std::map<int, size_t> position_of;  // index into result.keyframes, by frame index
  for (size_t i = 0; i < result.keyframes.size(); ++i) position_of[result.keyframes[i].index] = i;
  for (FramePose& frame : result.frames) {
    const auto place = position_of.find(frame.index);
    if (place == position_of.end()) continue;
    const FramePose& keyframe = result.keyframes[place->second];
    if (keyframe.map != frame.map) continue;
    frame.world_from_camera = keyframe.world_from_camera;
    frame.reference = keyframe.index;
  }
  for (const Map& map : maps) {
    for (const CovisibilityEdge& edge : FindCovisibilityEdges(map, kCovisible)) {
      result.covisibility.push_back({position_of.at(map.keyframe(edge.first).frame_index),
                                     position_of.at(map.keyframe(edge.second).frame_index),
                                     edge.shared});
    }
  }
  if (!result.keyframes.empty()) {
    const double count = static_cast<double>(result.keyframes.size());
    result.features_per_keyframe = num_matched / count;
    result.landmarks_per_keyframe = num_seen / count;
  }
  if (!maps.empty()) {
    // Number of first keyframes whose ground levels the world.
    constexpr size_t kStart = 20;
    std::vector<KeyframeId> first = maps.front().KeyframeIds();
    first.resize(std::min(first.size(), kStart));
    if (const auto ground = EstimateGround(maps.front(), first)) result.up = ground->up;
  }
  return result;
}

}  // namespace orb360
