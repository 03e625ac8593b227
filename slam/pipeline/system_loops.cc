// System's part that closes loops, joins maps and goes on in maps made earlier.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <omp.h>

#include "nn/base/check.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/loop_correction.h"
#include "slam/pipeline/system.h"

namespace orb360 {

void System::StartIn(Map map, const std::optional<KnownGround>& ground, bool is_kept) {
  ORB360_CHECK(num_processed_ == 0 && map.num_keyframes() > 0, num_processed_);
  // Frames of this run count from 0: those that the map was made of come before.
  int first_free = 0;
  for (const KeyframeId id : map.KeyframeIds()) {
    first_free = std::max(first_free, map.keyframe(id).frame_index + 1);
  }
  for (const KeyframeId id : map.KeyframeIds()) map.keyframe(id).frame_index -= first_free;
  map_ = std::move(map);
  ground_ = ground;
  keeps_map_ = is_kept;
  if (options_.loop.enabled) loops_->Learn(map_, 0);
  local_ = MakeLocalMap(map_, map_.KeyframeIds().back(), options_.keyframe.local_keyframes);
  relocalization_cursor_ = map_.keyframe_end() - 1;
  state_ = TrackingState::kLost;
  CountMap();
}

void System::StartLoopCorrection() {
  const KeyframeId reference = map_.LivingKeyframe(local_.reference);
  auto correct = [map = std::move(map_), loops = std::move(loops_), loop = std::move(*loop_),
                  finished = &finished_maps_, reference,
                  optimizer = options_.mapper.bundle.optimizer]() mutable {
    omp_set_num_threads(1);
    MappingResult result;
    result.loops = std::move(loops);
    result.reference = reference;
    result.joined_map = loop.finished_map;
    const Revisit& newest = loop.revisits.back();
    const Map& place_map = loop.finished_map ? (*finished)[*loop.finished_map] : map;
    const auto frame_of = [](const Map& m, KeyframeId id) {
      return m.keyframe(m.LivingKeyframe(id)).frame_index;
    };
    const ClosedLoop closed{frame_of(map, newest.keyframe), frame_of(place_map, newest.place)};
    if (loop.finished_map) {
      Map other = (*finished)[*loop.finished_map];
      result.keyframe_shift = other.keyframe_end();
      result.landmark_shift = other.landmark_end();
      result.reference += result.keyframe_shift;
      result.closed = closed;
      result.map = JoinMaps(loop, std::move(map), std::move(other), &result.correction);
    } else {
      result.corrections = CloseLoop(loop, &map, optimizer);
      if (!result.corrections.empty()) {
        result.closed = closed;
        result.correction = result.corrections[reference];
      }
      result.map = std::move(map);
    }
    return result;
  };
  map_ = Map();
  loop_.reset();
  job_ = MappingJob{std::async(std::launch::async, std::move(correct)), last_, cv::Mat(),
                    num_processed_ + options_.loop.correction_frames};
}

void System::AdoptJoinedMap(const MappingResult& result) {
  const int present = static_cast<int>(finished_maps_.size());
  const int joined = *result.joined_map;
  finished_maps_.erase(finished_maps_.begin() + joined);
  // The older map's unit counts.
  if (!grounds_[joined]) ground_.reset();
  grounds_.erase(grounds_.begin() + joined);
  for (auto& [index, placement] : placements_) {
    if (placement.map == present) ScalePlacement(index, result.correction.scale, &placement);
  }
  MapRenumbering maps{std::vector<int>(present + 1), present, result.keyframe_shift,
                      result.landmark_shift};
  for (int i = 0; i <= present; ++i) maps.number_of[i] = i > joined ? i - 1 : i;
  maps.number_of[joined] = present - 1;
  RenumberMaps(maps);
  for (std::vector<LandmarkId>* ids : {&last_.landmarks, &expected_, &found_}) {
    for (LandmarkId& id : *ids) id = id == kNoId ? kNoId : id + result.landmark_shift;
  }
}

// The map was bent, or moved into another one's world.
void System::FollowCorrection(const MappingResult& result) {
  (result.joined_map ? joints_ : closed_loops_).push_back(*result.closed);
  if (ground_) ground_->up = result.correction.rotation * ground_->up;
  dense_grounds_.clear();  // their unit may have been another
  StartBundle();
}

void System::SwitchToMap(int finished) {
  if (bundle_) AdoptBundle();
  CountSightings(&map_);
  map_.ForgetPictures(0);
  std::swap(map_, finished_maps_[finished]);
  std::swap(ground_, grounds_[finished]);
  dense_grounds_.clear();
  const int present = static_cast<int>(finished_maps_.size());
  MapRenumbering maps{.number_of = std::vector<int>(present + 1)};
  std::iota(maps.number_of.begin(), maps.number_of.end(), 0);
  std::swap(maps.number_of[finished], maps.number_of[present]);
  RenumberMaps(maps);
}

void System::RenumberMaps(const MapRenumbering& maps) {
  for (auto& [index, placement] : placements_) Renumber(maps, &placement);
  loops_->Renumber(maps.number_of, maps.shifted, maps.keyframe_shift);
}

void System::StartBundle() {
  Map before = map_;
  before.ForgetPictures(0);
  auto adjust = [map = before, ground = ReliableGround(), options = options_]() mutable {
    omp_set_num_threads(1);
    AdjustGlobally(options.loop.bundle_iterations, ground, options.loop.height_sigma, &map,
                   options.mapper.bundle.optimizer);
    return std::move(map);
  };
  const double frames = options_.loop.bundle_frames * map_.num_keyframes();
  bundle_ = BundleJob{std::async(std::launch::async, std::move(adjust)), std::move(before),
                      num_processed_ + static_cast<int>(std::ceil(frames))};
}

void System::AdoptBundle() {
  const Map adjusted = bundle_->adjusted.get();
  const std::vector<Similarity3> corrections = AdoptAdjustment(bundle_->before, adjusted, &map_);
  bundle_.reset();
  if (loop_) {  // found meanwhile, in the unit before
    for (Revisit& revisit : loop_->revisits) {
      const double of_place = loop_->finished_map ? 1.0 : corrections[revisit.place].scale;
      revisit.place_from_keyframe.scale *= of_place / corrections[revisit.keyframe].scale;
      revisit.place_from_keyframe.translation *= of_place;
    }
  }
  const KeyframeId reference = map_.LivingKeyframe(local_.reference);
  MoveTracked(corrections[reference]);
  ScalePlacements(corrections);
  local_ = MakeLocalMap(map_, reference, options_.keyframe.local_keyframes);
}

void System::ScalePlacements(const std::vector<Similarity3>& corrections) {
  if (corrections.empty()) return;
  const int present = static_cast<int>(finished_maps_.size());
  for (auto& [index, placement] : placements_) {
    if (placement.map != present) continue;
    ScalePlacement(index, corrections[placement.reference].scale, &placement);
  }
}

void System::MoveTracked(const Similarity3& correction) {
  last_.world_from_camera = TransformPose(correction, last_.world_from_camera);
  if (before_last_) {
    before_last_->world_from_camera = TransformPose(correction, before_last_->world_from_camera);
  }
}

}  // namespace orb360
