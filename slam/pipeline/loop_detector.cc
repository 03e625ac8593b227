#include "slam/pipeline/loop_detector.h"

#include <algorithm>
#include <cmath>

#include "nn/base/statistics.h"
#include "slam/map/covisibility.h"
#include "slam/pipeline/make_reconstruction.h"

namespace orb360 {
namespace {

double Angle(const Eigen::Quaterniond& turn) { return LogSo3(turn).norm(); }

/// Returns the length of the path from each keyframe to the newest, by id, world units; 0 for
/// removed ones.
std::vector<double> FindWays(const Map& map) {
  std::vector<double> ways(map.keyframe_end(), 0.0);
  double way = 0;
  const std::vector<KeyframeId> ids = map.KeyframeIds();
  for (size_t i = ids.size() - 1; i-- > 0;) {
    way += (map.keyframe(ids[i]).world_from_camera.translation -
            map.keyframe(ids[i + 1]).world_from_camera.translation)
               .norm();
    ways[ids[i]] = way;
  }
  return ways;
}

/// Returns the descriptors of the features that observe landmarks, because these are found again
/// from other positions.
std::vector<Descriptor> LandmarkDescriptors(const Keyframe& keyframe) {
  std::vector<Descriptor> descriptors;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId || !keyframe.features->keypoints[f].is_corner()) continue;
    descriptors.push_back(keyframe.features->descriptors[f]);
  }
  return descriptors;
}

}  // namespace

LoopDetector::LoopDetector(const LoopOptions& options, const TrackerOptions& tracker,
                           int local_keyframes, double pixel_sigma)
    : options_(options),
      tracker_(tracker),
      local_keyframes_(local_keyframes),
      pixel_sigma_(pixel_sigma) {}

void LoopDetector::Learn(const Keyframe& keyframe, int number) {
  index_.Add(LandmarkDescriptors(keyframe));
  places_.push_back({number, keyframe.id});
}

void LoopDetector::Learn(const Map& map, int number) {
  for (const KeyframeId id : map.KeyframeIds()) Learn(map.keyframe(id), number);
}

std::vector<std::pair<double, int>> LoopDetector::Rank(const std::vector<double>& scores,
                                                       const std::vector<uint8_t>& excluded,
                                                       int count) const {
  const int num_places = static_cast<int>(places_.size());
  std::vector<std::pair<double, int>> ranked;
  for (int p = 0; p < num_places; ++p) {
    if (excluded[p]) continue;
    double sum = 0;
    int summed = 0;
    for (int n = std::max(0, p - 1); n <= std::min(p + 1, num_places - 1); ++n) {
      if (excluded[n] || places_[n].map != places_[p].map) continue;
      sum += scores[n];
      ++summed;
    }
    ranked.push_back({sum / summed, p});
  }
  std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second > b.second);
  });
  // The neighbours of a candidate see the same landmarks and would add no information.
  constexpr int kApart = 4;  // places
  std::vector<std::pair<double, int>> best;
  for (const auto& candidate : ranked) {
    if (static_cast<int>(best.size()) == count) break;
    const bool is_near = std::any_of(best.begin(), best.end(), [&](const auto& b) {
      return std::abs(b.second - candidate.second) < kApart;
    });
    if (!is_near) best.push_back(candidate);
  }
  return best;
}

std::optional<TrackResult> LoopDetector::TrackAt(const Features& features, const Map& map,
                                                 const LocalMap& local, int num_threads) const {
  std::optional<TrackResult> result =
      TrackWithoutPrediction(features, local, pixel_sigma_, tracker_, num_threads);
  if (!result || result->num_inliers < options_.min_inliers) return std::nullopt;
  // A landmark that is often not found says nothing when it is not found here.
  const auto is_sure = [&](LandmarkId id) {
    constexpr size_t kObservations = 4;
    if (id == kNoId) return false;
    const Landmark& landmark = map.landmark(id);
    return landmark.observations.size() >= kObservations && 2 * landmark.found >= landmark.visible;
  };
  const auto expected = std::ranges::count_if(result->expected, is_sure);
  const auto found = std::ranges::count_if(result->landmarks, is_sure);
  if (static_cast<double>(found) < options_.min_found_fraction * static_cast<double>(expected)) {
    return std::nullopt;
  }
  return result;
}

std::optional<LoopDetector::FoundPose> LoopDetector::FindPose(const Features& features,
                                                              const Map& map,
                                                              std::span<const Map> finished,
                                                              int num_threads) const {
  const int present = static_cast<int>(finished.size());
  const std::vector<uint8_t> none(places_.size(), 0);
  for (const auto& [score, p] :
       Rank(index_.Score(features.descriptors), none, options_.max_candidates)) {
    const Place& place = places_[p];
    const Map& place_map = place.map == present ? map : finished[place.map];
    FoundPose found{
        place.map,
        MakeLocalMap(place_map, place_map.LivingKeyframe(place.keyframe), local_keyframes_),
        {}};
    if (std::optional<TrackResult> result =
            TrackAt(features, place_map, found.local, num_threads)) {
      found.result = std::move(*result);
      return found;
    }
  }
  return std::nullopt;
}

std::optional<Revisit> LoopDetector::Verify(
    const Map& map, KeyframeId newest, const Map& place_map, KeyframeId place,
    const std::function<bool(KeyframeId)>& may_close) const {
  const Keyframe& keyframe = map.keyframe(newest);
  const std::optional<TrackResult> result =
      TrackAt(*keyframe.features, place_map, MakeLocalMap(place_map, place, local_keyframes_));
  if (!result) return std::nullopt;
  // The scale is the median ratio of the ranges that the two maps give the same feature.
  std::vector<double> ratios;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId || result->landmarks[f] == kNoId) continue;
    const Eigen::Vector3d& here = map.landmark(keyframe.landmarks[f]).position;
    const Eigen::Vector3d& there = place_map.landmark(result->landmarks[f]).position;
    ratios.push_back((there - result->world_from_camera.translation).norm() /
                     (here - keyframe.world_from_camera.translation).norm());
  }
  constexpr size_t kMinRatios = 15;
  if (ratios.size() < kMinRatios) return std::nullopt;
  const double scale = Median(ratios);
  // Images are similar over a few metres, so the most similar place need not be the nearest one.
  const auto distance = [&](KeyframeId id) {
    return (place_map.keyframe(id).world_from_camera.translation -
            result->world_from_camera.translation)
        .norm();
  };
  KeyframeId nearest = place;
  for (const Map::Covisible& near :
       place_map.FindCovisible(place_map.keyframe(place).landmarks, kCovisible, place)) {
    const bool is_nearer = distance(near.keyframe) < distance(nearest);
    if (is_nearer && may_close(near.keyframe)) nearest = near.keyframe;
  }
  const Rigid3 place_from_camera =
      place_map.keyframe(nearest).world_from_camera.Inverse() * result->world_from_camera;
  return Revisit{newest,
                 nearest,
                 {scale, place_from_camera.rotation, place_from_camera.translation},
                 result->num_inliers};
}

std::optional<Loop> LoopDetector::Observe(const Map& map, KeyframeId newest,
                                          std::span<const Map> finished) {
  const int present = static_cast<int>(finished.size());
  const Keyframe& keyframe = map.keyframe(newest);
  const std::vector<uint8_t> is_connected = MarkCovisible(map, newest, kCovisible);
  const std::vector<double> ways = FindWays(map);
  const double min_way = options_.min_length * map.MedianRange(newest);
  const auto is_apart = [&](KeyframeId id) { return !is_connected[id] && ways[id] >= min_way; };
  std::vector<uint8_t> excluded(places_.size(), 0);
  double similarity_before = 0;  // the largest one among the places that the camera still sees
  const std::vector<double> scores = index_.Score(LandmarkDescriptors(keyframe));
  for (size_t p = 0; p < places_.size(); ++p) {
    if (places_[p].map != present) continue;
    if (is_apart(map.LivingKeyframe(places_[p].keyframe))) continue;
    excluded[p] = 1;
    similarity_before = std::max(similarity_before, scores[p]);
  }
  std::optional<Loop> loop;
  for (const auto& [score, p] : Rank(scores, excluded, 1)) {
    if (score < options_.min_similarity * similarity_before) break;
    const bool is_present = places_[p].map == present;
    const Map& place_map = is_present ? map : finished[places_[p].map];
    const KeyframeId place = place_map.LivingKeyframe(places_[p].keyframe);
    const std::optional<Revisit> revisit = Verify(
        map, newest, place_map, place, [&](KeyframeId id) { return !is_present || is_apart(id); });
    if (!revisit) continue;
    if (is_present) {
      const Similarity3 correction = CorrectionBy(*revisit, map, map);
      if (!IsPlausible(correction, keyframe.world_from_camera.translation, ways[revisit->place],
                       options_)) {
        continue;
      }
    }
    loop = Confirm(map, {is_present ? std::nullopt : std::optional(places_[p].map), *revisit},
                   finished);
    break;
  }
  Learn(keyframe, present);
  return loop;
}

std::optional<Loop> LoopDetector::Confirm(const Map& map, const Sighting& sighting,
                                          std::span<const Map> finished) {
  std::erase_if(sightings_, [&](const Sighting& s) {
    return s.revisit.keyframe <= sighting.revisit.keyframe - 2 * options_.min_agreeing;
  });
  sightings_.push_back(sighting);
  const Map& place_map = sighting.finished_map ? finished[*sighting.finished_map] : map;
  const Similarity3 correction = CorrectionBy(sighting.revisit, map, place_map);
  const Eigen::Vector3d here = map.PoseOf(sighting.revisit.keyframe).translation;
  const double range = correction.scale * map.MedianRange(sighting.revisit.keyframe);
  Loop loop{sighting.finished_map, {}};
  for (const Sighting& other : sightings_) {
    if (other.finished_map != sighting.finished_map) continue;
    const Similarity3 theirs = CorrectionBy(other.revisit, map, place_map);
    if ((theirs * here - correction * here).norm() <= options_.max_disagreement * range &&
        Angle(theirs.rotation * correction.rotation.conjugate()) <= options_.max_disagreement &&
        std::abs(std::log(theirs.scale / correction.scale)) <= options_.max_disagreement) {
      loop.revisits.push_back(other.revisit);
    }
  }
  if (static_cast<int>(loop.revisits.size()) < options_.min_agreeing) return std::nullopt;
  sightings_.clear();
  return loop;
}

void LoopDetector::Renumber(std::span<const int> number_of, int shifted, KeyframeId shift) {
  for (Place& place : places_) {
    if (place.map == shifted) place.keyframe += shift;
    place.map = number_of[place.map];
  }
  sightings_.clear();
}

}  // namespace orb360
