#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "nn/base/statistics.h"
#include "slam/features/hamming.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/map/map.h>

namespace orb360 {
namespace {

constexpr double kLevelsPerOctave = 4.0;

// Returns the descriptor with the smallest median distance to the others, which is robust against a
// few wrong ones.
const Descriptor& MostTypical(std::span<const Descriptor> descriptors) {
  std::vector<uint16_t> distances(descriptors.size());
  size_t best = 0;
  int best_median = NearestTwo::kNone;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    HammingDistances(descriptors[i], descriptors, distances);
    const uint16_t median = Median(distances);
    if (median < best_median) {
      best_median = median;
      best = i;
    }
  }
  return descriptors[best];
}

void ScaleRanges(double factor, Keyframe* keyframe) {
  for (RangePrior& prior : keyframe->range_priors) prior.range *= static_cast<float>(factor);
}

}  // namespace

std::vector<uint8_t> FindMappedCorners(const Keyframe& keyframe) {
  const std::vector<int>& corners = keyframe.features->corners;
  std::vector<uint8_t> is_mapped(corners.size(), 0);
  for (size_t f = 0; f < corners.size(); ++f) {
    if (keyframe.landmarks[f] != kNoId) is_mapped[corners[f]] = 1;
  }
  return is_mapped;
}

double RangeAtLevelZero(double range, int level) {
  return range * std::exp2(level / kLevelsPerOctave);
}

int PredictLevel(double max_range, double range) {
  return static_cast<int>(std::lround(kLevelsPerOctave * std::log2(max_range / range)));
}

const Observation* Landmark::FindObservation(KeyframeId from) const {
  const auto place = std::ranges::find(observations, from, &Observation::keyframe);
  return place == observations.end() ? nullptr : &*place;
}

Observation* Landmark::FindObservation(KeyframeId from) {
  return const_cast<Observation*>(std::as_const(*this).FindObservation(from));
}

KeyframeId Map::AddKeyframe(int frame_index, double timestamp, const Rigid3& world_from_camera,
                            std::shared_ptr<const Features> features) {
  ORB360_CHECK(features != nullptr);
  const KeyframeId id = keyframe_end();
  const int num_features = features->size();
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.frame_index = frame_index;
  keyframe.timestamp = timestamp;
  keyframe.world_from_camera = world_from_camera;
  keyframe.features = std::move(features);
  keyframe.landmarks.assign(num_features, kNoId);
  keyframes_.push_back(std::move(keyframe));
  successors_.emplace_back();
  ++num_keyframes_;
  return id;
}

void Map::RemoveKeyframe(KeyframeId id, KeyframeId successor) {
  ORB360_CHECK(id != successor && HasKeyframe(successor), id, successor);
  const std::vector<LandmarkId> landmarks = keyframe(id).landmarks;
  for (const LandmarkId landmark : landmarks) {
    if (landmark != kNoId) RemoveObservation(landmark, id);
  }
  successors_[id] = {
      successor, keyframe(successor).world_from_camera.Inverse() * keyframe(id).world_from_camera};
  keyframes_[id].reset();
  --num_keyframes_;
}

void Map::ForgetImages(int num_kept) {
  int num_newer = 0;
  for (KeyframeId id = keyframe_end() - 1; id >= 0; --id) {
    if (HasKeyframe(id) && num_newer++ >= num_kept) keyframes_[id]->image.reset();
  }
}

LandmarkId Map::AddLandmark(const Eigen::Vector3d& position, const Color& color) {
  Landmark landmark;
  landmark.id = landmark_end();
  landmark.position = position;
  landmark.mean_direction.setZero();
  landmark.color = color;
  landmark.first_keyframe = keyframe_end() - 1;
  landmarks_.push_back(std::move(landmark));
  merged_into_.push_back(kNoId);
  ++num_landmarks_;
  return landmark_end() - 1;
}

void Map::RemoveLandmark(LandmarkId id) {
  for (const Observation& observation : landmark(id).observations) {
    keyframe(observation.keyframe).landmarks[observation.feature] = kNoId;
  }
  landmarks_[id].reset();
  --num_landmarks_;
}

void Map::MergeLandmark(LandmarkId from, LandmarkId to) {
  ORB360_CHECK(from != to, from);
  Landmark& target = landmark(to);
  const std::vector<Observation> moved = landmark(from).observations;
  target.visible += landmark(from).visible;
  target.found += landmark(from).found;
  RemoveLandmark(from);
  merged_into_[from] = to;
  for (const Observation& observation : moved) {
    if (target.FindObservation(observation.keyframe) != nullptr) continue;
    AddObservation(to, observation.keyframe, observation.feature);
  }
}

void Map::AddObservation(LandmarkId landmark_id, KeyframeId keyframe_id, int feature) {
  LandmarkId& slot = keyframe(keyframe_id).landmarks[feature];
  ORB360_CHECK(slot == kNoId, landmark_id, keyframe_id, feature);
  std::vector<Observation>& observations = landmark(landmark_id).observations;
  const auto place =
      std::lower_bound(observations.begin(), observations.end(), keyframe_id,
                       [](const Observation& o, KeyframeId k) { return o.keyframe < k; });
  ORB360_CHECK(place == observations.end() || place->keyframe != keyframe_id, landmark_id,
               keyframe_id);
  observations.insert(place, {keyframe_id, feature});
  slot = landmark_id;
}

void Map::RemoveObservation(LandmarkId landmark_id, KeyframeId keyframe_id) {
  std::vector<Observation>& observations = landmark(landmark_id).observations;
  const auto place = std::ranges::find(observations, keyframe_id, &Observation::keyframe);
  ORB360_CHECK(place != observations.end(), landmark_id, keyframe_id);
  keyframe(keyframe_id).landmarks[place->feature] = kNoId;
  observations.erase(place);
}

void Map::UpdateAppearance(LandmarkId id) {
  Landmark& target = landmark(id);
  ORB360_CHECK(!target.observations.empty(), id);
  std::vector<Descriptor> descriptors;
  Eigen::Vector3d directions = Eigen::Vector3d::Zero();
  for (const Observation& observation : target.observations) {
    const Keyframe& observer = keyframe(observation.keyframe);
    descriptors.push_back(observer.features->descriptors[observation.feature]);
    directions += (target.position - observer.world_from_camera.translation).normalized();
  }
  target.descriptor = MostTypical(descriptors);
  // Directions from opposite sides cancel; then the landmark may be seen from any direction.
  target.mean_direction =
      directions.norm() > 1e-9 ? directions.normalized() : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const Observation& newest = target.observations.back();
  const Keyframe& observer = keyframe(newest.keyframe);
  target.max_range =
      RangeAtLevelZero((target.position - observer.world_from_camera.translation).norm(),
                       observer.features->keypoints[newest.feature].level);
}

Keyframe& Map::keyframe(KeyframeId id) {
  ORB360_CHECK(HasKeyframe(id), id);
  return *keyframes_[id];
}
const Keyframe& Map::keyframe(KeyframeId id) const {
  ORB360_CHECK(HasKeyframe(id), id);
  return *keyframes_[id];
}
Landmark& Map::landmark(LandmarkId id) {
  ORB360_CHECK(HasLandmark(id), id);
  return *landmarks_[id];
}
const Landmark& Map::landmark(LandmarkId id) const {
  ORB360_CHECK(HasLandmark(id), id);
  return *landmarks_[id];
}

LandmarkId Map::Resolve(LandmarkId id) const {
  while (id != kNoId && !landmarks_[id].has_value()) id = merged_into_[id];
  return id;
}

Rigid3 Map::PoseOf(KeyframeId id) const {
  if (HasKeyframe(id)) return keyframe(id).world_from_camera;
  return PoseOf(successors_[id].keyframe) * successors_[id].successor_from_camera;
}

KeyframeId Map::LivingKeyframe(KeyframeId id) const {
  while (!HasKeyframe(id)) id = successors_[id].keyframe;
  return id;
}

std::vector<KeyframeId> Map::KeyframeIds() const {
  std::vector<KeyframeId> ids;
  for (KeyframeId id = 0; id < keyframe_end(); ++id) {
    if (HasKeyframe(id)) ids.push_back(id);
  }
  return ids;
}

std::vector<Map::Covisible> Map::FindCovisible(std::span<const LandmarkId> landmarks,
                                               int min_shared, KeyframeId except) const {
  std::vector<int> shared(keyframes_.size(), 0);
  for (const LandmarkId id : landmarks) {
    if (id == kNoId || !HasLandmark(id)) continue;
    for (const Observation& observation : landmark(id).observations) ++shared[observation.keyframe];
  }
  std::vector<Covisible> result;
  for (KeyframeId id = keyframe_end() - 1; id >= 0; --id) {
    if (id != except && shared[id] >= std::max(1, min_shared)) result.push_back({id, shared[id]});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Covisible& a, const Covisible& b) { return a.shared > b.shared; });
  return result;
}

double Map::MedianRange(KeyframeId id) const {
  const Keyframe& observer = keyframe(id);
  std::vector<double> ranges;
  for (const LandmarkId seen : observer.landmarks) {
    if (seen == kNoId) continue;
    ranges.push_back((landmark(seen).position - observer.world_from_camera.translation).norm());
  }
  return ranges.empty() ? 0 : Median(ranges);
}

void Map::Transform(const Similarity3& target_from_world) {
  for (std::optional<Keyframe>& keyframe : keyframes_) {
    if (keyframe) {
      keyframe->world_from_camera = TransformPose(target_from_world, keyframe->world_from_camera);
      ScaleRanges(target_from_world.scale, &*keyframe);
    }
  }
  for (Successor& successor : successors_) {
    successor.successor_from_camera.translation *= target_from_world.scale;
  }
  for (std::optional<Landmark>& landmark : landmarks_) {
    if (!landmark) continue;
    landmark->position = target_from_world * landmark->position;
    landmark->mean_direction = target_from_world.rotation * landmark->mean_direction;
    landmark->max_range *= target_from_world.scale;
  }
}

void Map::Deform(std::span<const Similarity3> corrections) {
  ORB360_CHECK(corrections.size() == keyframes_.size(), corrections.size(), keyframes_.size());
  for (std::optional<Landmark>& landmark : landmarks_) {
    if (!landmark || landmark->observations.empty()) continue;
    const std::vector<Observation>& observations = landmark->observations;
    const Similarity3& correction = corrections[observations[observations.size() / 2].keyframe];
    landmark->position = correction * landmark->position;
    landmark->mean_direction = correction.rotation * landmark->mean_direction;
    landmark->max_range *= correction.scale;
  }
  for (KeyframeId id = 0; id < keyframe_end(); ++id) {
    if (keyframes_[id]) {
      Rigid3& pose = keyframes_[id]->world_from_camera;
      pose = TransformPose(corrections[id], pose);
      ScaleRanges(corrections[id].scale, &*keyframes_[id]);
    } else {
      successors_[id].successor_from_camera.translation *= corrections[id].scale;
    }
  }
}

void Map::Append(const Map& other) {
  const KeyframeId first_keyframe = keyframe_end();
  const LandmarkId first_landmark = landmark_end();
  const auto shift = [](int id, int by) { return id == kNoId ? kNoId : id + by; };
  for (const std::optional<Keyframe>& theirs : other.keyframes_) {
    keyframes_.push_back(theirs);
    if (!theirs) continue;
    keyframes_.back()->id += first_keyframe;
    for (LandmarkId& id : keyframes_.back()->landmarks) id = shift(id, first_landmark);
    for (GroundStepFrom& step : keyframes_.back()->ground_steps) step.keyframe += first_keyframe;
  }
  for (const Successor& theirs : other.successors_) {
    successors_.push_back({shift(theirs.keyframe, first_keyframe), theirs.successor_from_camera});
  }
  for (const std::optional<Landmark>& theirs : other.landmarks_) {
    landmarks_.push_back(theirs);
    if (!theirs) continue;
    landmarks_.back()->id += first_landmark;
    landmarks_.back()->first_keyframe += first_keyframe;
    for (Observation& o : landmarks_.back()->observations) o.keyframe += first_keyframe;
    if (theirs->patch) {
      LandmarkPatch patch = *theirs->patch;
      patch.keyframe += first_keyframe;
      landmarks_.back()->patch = std::make_shared<const LandmarkPatch>(patch);
    }
  }
  for (const LandmarkId theirs : other.merged_into_) {
    merged_into_.push_back(shift(theirs, first_landmark));
  }
  num_keyframes_ += other.num_keyframes_;
  num_landmarks_ += other.num_landmarks_;
}

void Map::CheckConsistency() const {
  int landmarks = 0;
  for (LandmarkId id = 0; id < landmark_end(); ++id) {
    if (!HasLandmark(id)) continue;
    ++landmarks;
    KeyframeId previous = kNoId;
    for (const Observation& observation : landmark(id).observations) {
      ORB360_CHECK(observation.keyframe > previous, id, observation.keyframe);
      previous = observation.keyframe;
      ORB360_CHECK(keyframe(observation.keyframe).landmarks[observation.feature] == id, id,
                   observation.keyframe, observation.feature);
    }
  }
  ORB360_CHECK(landmarks == num_landmarks_, landmarks, num_landmarks_);
  int keyframes = 0;
  for (const KeyframeId id : KeyframeIds()) {
    ++keyframes;
    const std::vector<LandmarkId>& seen = keyframe(id).landmarks;
    for (size_t feature = 0; feature < seen.size(); ++feature) {
      if (seen[feature] == kNoId) continue;
      const std::vector<Observation>& observations = landmark(seen[feature]).observations;
      const bool listed = std::any_of(observations.begin(), observations.end(), [&](const auto& o) {
        return o.keyframe == id && o.feature == static_cast<int>(feature);
      });
      ORB360_CHECK(listed, id, feature, seen[feature]);
    }
  }
  ORB360_CHECK(keyframes == num_keyframes_, keyframes, num_keyframes_);
}

}  // namespace orb360
