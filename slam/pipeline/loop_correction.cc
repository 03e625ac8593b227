#include "slam/pipeline/loop_correction.h"

#include <algorithm>

#include "nn/base/statistics.h"
#include "slam/map/covisibility.h"
#include "slam/optimization/pose_graph.h"
#include "slam/pipeline/landmark_fusion.h"
#include "slam/pipeline/observation_alignment.h"

namespace orb360 {
namespace {

// Least number of landmarks that two keyframes share to have an edge in the pose graph.
constexpr int kHeldShared = 30;
// Weight of a revisit relative to an edge of covisibility, for each landmark. A revisit is accurate
// to centimetres. The edges along the way are many times as many, but depend on the same landmarks
// and share an error of metres.
constexpr double kRevisitWeight = 1000.0;
// Number of keyframes on either side of a loop whose landmarks are fused, for each revisit.
constexpr int kFusedNeighbours = 6;
// Search window for that, in standard deviations. It is wide, because both sides may still be
// deformed.
constexpr double kFusionSigmas = 10.0;

void AddSurroundings(const Map& map, KeyframeId center, std::vector<KeyframeId>* keyframes) {
  keyframes->push_back(center);
  int added = 0;
  for (const Map::Covisible& near : map.FindCovisible(map.keyframe(center).landmarks, 1, center)) {
    if (added++ == kFusedNeighbours) break;
    keyframes->push_back(near.keyframe);
  }
}

void SortUnique(std::vector<KeyframeId>* ids) {
  std::sort(ids->begin(), ids->end());
  ids->erase(std::unique(ids->begin(), ids->end()), ids->end());
}

/// Fuses the landmarks that both ends of a loop see.
void FuseEnds(const std::vector<Revisit>& revisits, Map* map) {
  std::vector<KeyframeId> present;
  std::vector<KeyframeId> past;
  for (const Revisit& revisit : revisits) {
    AddSurroundings(*map, map->LivingKeyframe(revisit.keyframe), &present);
    AddSurroundings(*map, map->LivingKeyframe(revisit.place), &past);
  }
  SortUnique(&present);
  SortUnique(&past);
  for (const KeyframeId id : present) {
    FuseLandmarks(id, LandmarksSeenBy(past, *map), kFusionSigmas, map);
  }
  for (const KeyframeId id : past) {
    FuseLandmarks(id, LandmarksSeenBy(present, *map), kFusionSigmas, map);
  }
  for (const KeyframeId id : present) AlignObservations(id, std::nullopt, map);
}

void FillRemoved(const Map& map, std::vector<Similarity3>* corrections) {
  for (KeyframeId id = 0; id < map.keyframe_end(); ++id) {
    if (!map.HasKeyframe(id)) (*corrections)[id] = (*corrections)[map.LivingKeyframe(id)];
  }
}

/// Returns the numbers of the maps after a merge. The present map, whose number is `num_finished`,
/// replaces the finished one, and the numbers of the maps after that one decrease by one.
MapRenumbering NumbersAfterMerge(size_t num_finished, int merged) {
  const int present = static_cast<int>(num_finished);
  MapRenumbering renumbering{.number_of = std::vector<int>(num_finished + 1), .shifted = present};
  for (int i = 0; i <= present; ++i) renumbering.number_of[i] = i > merged ? i - 1 : i;
  renumbering.number_of[merged] = present - 1;
  return renumbering;
}

/// Returns the factor by which the surroundings of a keyframe have grown.
double ScaleOfChange(const Keyframe& before, const Map& map_before, const Map& map_after) {
  const Eigen::Vector3d& after = map_after.keyframe(before.id).world_from_camera.translation;
  std::vector<double> ratios;
  for (const LandmarkId id : before.landmarks) {
    if (id == kNoId || !map_after.HasLandmark(id)) continue;
    ratios.push_back(
        (map_after.landmark(id).position - after).norm() /
        (map_before.landmark(id).position - before.world_from_camera.translation).norm());
  }
  return ratios.empty() ? 1.0 : Median(ratios);
}

}  // namespace

std::vector<Similarity3> CloseLoop(const Loop& loop, Map* map, Optimizer optimizer) {
  const std::vector<KeyframeId> ids = map->KeyframeIds();
  std::vector<int> node_of(map->keyframe_end(), -1);
  PoseGraph graph;
  for (const KeyframeId id : ids) {
    node_of[id] = static_cast<int>(graph.world_from_node.size());
    graph.world_from_node.push_back(ToSimilarity(map->keyframe(id).world_from_camera));
  }
  graph.fixed.assign(ids.size(), 0);
  graph.fixed.front() = 1;
  graph.unit = map->MedianRange(map->LivingKeyframe(loop.revisits.back().keyframe));
  const std::vector<Similarity3> before = graph.world_from_node;
  const auto link = [&](int a, int b, double weight) {
    graph.edges.push_back({a, b, before[a].Inverse() * before[b], weight});
  };
  // Edges along the chain of keyframes connect those that share few landmarks with others.
  for (size_t i = 1; i < ids.size(); ++i) {
    link(static_cast<int>(i) - 1, static_cast<int>(i), 1.0);
  }
  for (const CovisibilityEdge& edge : FindCovisibilityEdges(*map, kHeldShared)) {
    link(node_of[edge.first], node_of[edge.second], edge.shared);
  }
  const size_t num_old_edges = graph.edges.size();
  for (const Revisit& revisit : loop.revisits) {
    if (!map->HasKeyframe(revisit.keyframe) || !map->HasKeyframe(revisit.place)) continue;
    graph.edges.push_back({node_of[revisit.place], node_of[revisit.keyframe],
                           revisit.place_from_keyframe, kRevisitWeight * revisit.shared});
  }
  if (graph.edges.size() == num_old_edges) return {};
  if (!SolvePoseGraph({.optimizer = optimizer}, &graph).usable) return {};

  std::vector<Similarity3> corrections(map->keyframe_end());
  for (const KeyframeId id : ids) {
    corrections[id] = graph.world_from_node[node_of[id]] * before[node_of[id]].Inverse();
  }
  FillRemoved(*map, &corrections);
  map->Deform(corrections);
  FuseEnds(loop.revisits, map);
  return corrections;
}

Map MergeMaps(const Loop& loop, Map present, Map finished, Similarity3* correction) {
  *correction = CorrectionBy(loop.revisits.back(), present, finished);
  present.Transform(*correction);
  const KeyframeId shift = finished.keyframe_end();
  finished.Append(present);
  std::vector<Revisit> revisits = loop.revisits;
  for (Revisit& revisit : revisits) revisit.keyframe += shift;
  FuseEnds(revisits, &finished);
  return finished;
}

std::vector<Similarity3> AdoptAdjustment(const Map& before, const Map& adjusted, Map* map) {
  std::vector<Similarity3> corrections(map->keyframe_end());
  KeyframeId latest = kNoId;  // the newest adjusted keyframe that still exists
  for (const KeyframeId id : before.KeyframeIds()) {
    const Keyframe& old = before.keyframe(id);
    const Rigid3& then = old.world_from_camera;
    const Rigid3& now = adjusted.keyframe(id).world_from_camera;
    Similarity3& correction = corrections[id];
    correction.scale = ScaleOfChange(old, before, adjusted);
    correction.rotation = (now.rotation * then.rotation.conjugate()).normalized();
    correction.translation =
        now.translation - correction.scale * (correction.rotation * then.translation);
    if (map->HasKeyframe(id)) latest = id;
  }
  for (KeyframeId id = before.keyframe_end(); id < map->keyframe_end(); ++id) {
    if (!map->HasKeyframe(id)) continue;
    KeyframeId leader = latest;
    for (const Map::Covisible& near : map->FindCovisible(map->keyframe(id).landmarks, 1, id)) {
      if (near.keyframe >= before.keyframe_end()) continue;
      leader = near.keyframe;
      break;
    }
    if (leader != kNoId) corrections[id] = corrections[leader];
  }
  FillRemoved(*map, &corrections);

  // Adjusted landmarks move to their adjusted positions, with all changes since the copy was made.
  struct Target {
    LandmarkId id;
    Eigen::Vector3d position;
  };
  std::vector<Target> targets;
  for (LandmarkId id = 0; id < before.landmark_end(); ++id) {
    if (!before.HasLandmark(id) || !adjusted.HasLandmark(id) || !map->HasLandmark(id)) continue;
    const std::vector<Observation>& seen = map->landmark(id).observations;
    if (seen.empty()) continue;
    const Similarity3& c = corrections[seen[seen.size() / 2].keyframe];
    targets.push_back({id, adjusted.landmark(id).position +
                               c.scale * (c.rotation * (map->landmark(id).position -
                                                        before.landmark(id).position))});
  }
  map->Deform(corrections);
  for (const Target& target : targets) map->landmark(target.id).position = target.position;
  return corrections;
}

CorrectedLoop CorrectLoop(LoopCorrection job, Optimizer optimizer) {
  const Loop& loop = job.loop;
  Map& map = job.active.map;
  const Revisit& newest = loop.revisits.back();
  const Map& place_map = loop.finished_map ? job.finished[*loop.finished_map] : map;
  const auto frame_of = [](const Map& m, KeyframeId id) {
    return m.keyframe(m.LivingKeyframe(id)).frame_index;
  };
  const ClosedLoop closed{frame_of(map, newest.keyframe), frame_of(place_map, newest.place)};

  CorrectedLoop result{.active = std::move(job.active)};
  MapUpdate& update = result.update;
  update.reference = job.reference;
  if (loop.finished_map) {
    Map finished = place_map;
    MapRenumbering renumbering = NumbersAfterMerge(job.finished.size(), *loop.finished_map);
    renumbering.keyframe_shift = finished.keyframe_end();
    renumbering.landmark_shift = finished.landmark_end();
    update.reference += renumbering.keyframe_shift;
    const KeyframeId num_corrected = result.active.map.keyframe_end();
    result.active.map =
        MergeMaps(loop, std::move(result.active.map), std::move(finished), &update.correction);
    update.corrections.assign(num_corrected, update.correction);
    update.renumbering = std::move(renumbering);
    result.closed = closed;
  } else {
    update.corrections = CloseLoop(loop, &result.active.map, optimizer);
    if (!update.corrections.empty()) {
      update.correction = update.corrections[job.reference];
      result.closed = closed;
    }
  }
  return result;
}

}  // namespace orb360
