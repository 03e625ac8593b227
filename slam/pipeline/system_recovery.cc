// System's part that begins maps and finds a lost camera.

#include <algorithm>
#include <utility>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/initializer.h"
#include "slam/pipeline/panoramic_triangulation.h"
#include "slam/pipeline/system.h"

namespace orb360 {

void System::RecoverFrame(const PendingFrame& frame) {
  std::optional<TrackResult> result = Relocalize(*frame.features);
  if (result) {
    state_ = TrackingState::kTracking;
    if (!initialized_at_) initialized_at_ = frame.index;  // in a map made earlier
    ++num_relocalized_;
    before_last_.reset();
    AcceptTracking(frame, std::move(*result));
    before_last_.reset();
    TrackPendingBackwards(last_);
    return;
  }
  if (!keeps_map_ && num_processed_ - lost_since_ >= options_.recovery.patience_frames) {
    InitializeMap(frame);
  } else {
    Remember(frame);
  }
}

std::optional<TrackResult> System::Relocalize(const Features& features) {
  std::optional<TrackResult> result =
      TrackWithoutPrediction(features, local_, pixel_sigma_, options_.tracker);
  if (!result && options_.loop.enabled) {
    if (auto found = loops_->FindPose(features, map_, finished_maps_)) {
      if (found->map < static_cast<int>(finished_maps_.size())) SwitchToMap(found->map);
      local_ = std::move(found->local);
      result = std::move(found->result);
    }
  }
  for (int i = 0; !result && i < options_.recovery.keyframes_per_frame; ++i) {
    // From the newest keyframe backwards, round and round; neighbours see the same.
    constexpr int kStep = 3;
    if (relocalization_cursor_ < 0) relocalization_cursor_ = map_.keyframe_end() - 1;
    const KeyframeId id = map_.LivingKeyframe(relocalization_cursor_);
    relocalization_cursor_ -= kStep;
    const LocalMap around = MakeLocalMap(map_, id, options_.keyframe.local_keyframes);
    result = TrackWithoutPrediction(features, around, pixel_sigma_, options_.tracker);
    if (result) local_ = around;
  }
  return result;
}

void System::TrackPendingBackwards(TrackedFrame last) {
  std::optional<TrackedFrame> before;
  std::sort(pending_.begin(), pending_.end(),
            [](const PendingFrame& a, const PendingFrame& b) { return a.index > b.index; });
  for (const PendingFrame& frame : pending_) {
    if (!frame.features) continue;
    Rigid3 predicted = last.world_from_camera;
    if (before) {
      predicted =
          last.world_from_camera * (before->world_from_camera.Inverse() * last.world_from_camera);
    }
    std::optional<TrackResult> result = TrackFromPrediction(*frame.features, predicted, last,
                                                            local_, pixel_sigma_, options_.tracker);
    if (!result) {
      result = TrackWithoutPrediction(*frame.features, local_, pixel_sigma_, options_.tracker);
    }
    if (!result) continue;
    before = std::move(last);
    last = {frame.index,
            frame.timestamp,
            frame.features,
            result->world_from_camera,
            std::move(result->landmarks),
            result->num_inliers};
    Place(last);
  }
  for (const PendingFrame& frame : pending_) {
    if (!frame.turn || placements_.contains(frame.index)) continue;
    const auto reference = placements_.find(frame.turn->reference);
    if (reference == placements_.end()) continue;
    Placement turned = reference->second;
    turned.timestamp = frame.timestamp;
    turned.reference_from_camera.rotation =
        turned.reference_from_camera.rotation * frame.turn->reference_from_camera;
    turned.sightings.clear();
    placements_[frame.index] = std::move(turned);
  }
  pending_.clear();
}

void System::InitializeMap(const PendingFrame& frame) {
  const auto find_reference = [&] {
    return std::find_if(pending_.begin(), pending_.end(),
                        [&](const PendingFrame& p) { return p.index == reference_index_; });
  };
  for (int attempt = 0; attempt < 2 && !pending_.empty(); ++attempt) {
    auto reference = find_reference();
    if (reference == pending_.end()) reference = std::prev(pending_.end());
    reference_index_ = reference->index;
    const InitializationResult result =
        InitializeFromTwoViews(*reference->features, *frame.features, options_.initializer,
                               options_.mapper.bundle.optimizer);
    if (result.map) {
      CreateMap(*reference, frame, *result.map);
      return;
    }
    if (result.failure == InitializationFailure::kLittleParallax) {
      PendingFrame turned = frame;
      turned.turn = {reference_index_, *result.turn};
      Remember(std::move(turned));
      return;
    }
    if (reference_index_ == pending_.back().index) break;
    reference_index_ = pending_.back().index;  // once more with the frame just before
  }
  Remember(frame);
}

void System::Remember(PendingFrame frame) {
  pending_.push_back(std::move(frame));
  const auto is_kept = [](const PendingFrame& p) { return p.features != nullptr; };
  if (std::count_if(pending_.begin(), pending_.end(), is_kept) <=
      options_.recovery.max_pending_frames) {
    return;
  }
  const auto oldest = std::find_if(pending_.begin(), pending_.end(), [&](const PendingFrame& p) {
    return is_kept(p) && p.index != reference_index_;
  });
  if (oldest->turn) {
    oldest->features.reset();
  } else {
    pending_.erase(oldest);
  }
}

void System::CreateMap(const PendingFrame& first, const PendingFrame& second,
                       const TwoViewMap& views) {
  Map map;
  const KeyframeId keyframe1 =
      map.AddKeyframe(first.index, first.timestamp, Rigid3(), first.features);
  const KeyframeId keyframe2 =
      map.AddKeyframe(second.index, second.timestamp, views.world_from_camera2, second.features);
  for (const TwoViewMap::Point& point : views.points) {
    const LandmarkId landmark =
        map.AddLandmark(point.position, second.features->colors[point.feature2]);
    map.AddObservation(landmark, keyframe1, point.feature1);
    map.AddObservation(landmark, keyframe2, point.feature2);
    map.UpdateAppearance(landmark);
  }
  TriangulateNewLandmarks(keyframe2, options_.mapper.triangulation, &map);
  AdjustGlobally(10, std::nullopt, 0.0, &map, options_.mapper.bundle.optimizer);

  // Gauge: the surroundings are one unit of length away; a later map goes on where the last pose
  // of the one before was, in its scale.
  Similarity3 gauge;
  gauge.scale = 1.0 / map.MedianRange(keyframe2);
  if (map_.num_keyframes() > 0) {
    gauge.scale *= local_.median_range;
    gauge.rotation = last_.world_from_camera.rotation;
    gauge.translation = last_.world_from_camera.translation;
    if (bundle_) AdoptBundle();
    FinishMap();
  }
  if (!initialized_at_) initialized_at_ = second.index;
  map.Transform(gauge);
  map_ = std::move(map);
  if (options_.loop.enabled) loops_->Learn(map_, static_cast<int>(finished_maps_.size()));

  state_ = TrackingState::kTracking;
  local_ = MakeLocalMap(map_, keyframe2, options_.keyframe.local_keyframes);
  expected_.clear();
  found_.clear();
  before_last_ = {first.index,
                  first.timestamp,
                  first.features,
                  map_.keyframe(keyframe1).world_from_camera,
                  map_.keyframe(keyframe1).landmarks,
                  0};
  last_ = {second.index,
           second.timestamp,
           second.features,
           map_.keyframe(keyframe2).world_from_camera,
           map_.keyframe(keyframe2).landmarks,
           0};
  last_.num_inliers = static_cast<int>(std::count_if(last_.landmarks.begin(), last_.landmarks.end(),
                                                     [](LandmarkId id) { return id != kNoId; }));
  Place(*before_last_);
  Place(last_);
  std::erase_if(pending_,
                [index = first.index](const PendingFrame& p) { return p.index == index; });
  TrackPendingBackwards(last_);
}

}  // namespace orb360
