// How the front end loses the camera and finds it again.

#include <utility>

#include "slam/pipeline/front_end.h"

namespace orb360 {

void FrontEnd::Lose(PendingFrame frame, int num_frames, const Map& map) {
  state_ = Lost{.before = std::get<Tracking>(std::move(state_)),
                .since = num_frames,
                .next_keyframe = map.keyframe_end() - 1};
  ground_motion_.reset();
  ++events_.num_lost;
  pending_.ResetReference();
  pending_.Remember(std::move(frame));
}

void FrontEnd::StartLost(const Map& map) {
  local_ = MakeLocalMap(map, map.KeyframeIds().back(), options_.keyframe.local_keyframes);
  state_ = Lost{.next_keyframe = map.keyframe_end() - 1};
}

std::optional<Relocalization> FrontEnd::Find(const PendingFrame& frame, int num_threads,
                                             Atlas* atlas) {
  const std::optional<Tracking>& before = lost()->before;
  if (before && frame.timestamp - before->last.timestamp < kPredictable) {
    std::optional<TrackResult> result =
        TrackFromPrediction(*frame.features, PredictPose(*before, frame.timestamp), before->last,
                            local_, pixel_sigma_, options_.tracker, std::nullopt, num_threads);
    if (result) {
      return Relocalization{.map = atlas->present_number(),
                            .local = local_,
                            .result = std::move(*result),
                            .continues_motion = true};
    }
  }
  return Relocalize(*frame.features, local_, pixel_sigma_, options_, num_threads, atlas,
                    &std::get<Lost>(state_).next_keyframe);
}

void FrontEnd::Resume(const PendingFrame& frame, Relocalization found, int num_threads,
                      Atlas* atlas) {
  local_ = std::move(found.local);
  if (!events_.initialized_at) events_.initialized_at = frame.index;  // in a loaded map
  ++events_.num_relocalized;
  counts_.Add(found.result);
  const TrackedFrame tracked = MakeTracked(frame, std::move(found.result));
  if (found.continues_motion) InterpolatePending(lost()->before->last, tracked, atlas);
  state_ = Tracking{.last = tracked};
  Anchor(tracked, atlas);
  TrackPendingBackwards(tracked, num_threads, atlas);
}

void FrontEnd::TrackPendingBackwards(TrackedFrame last, int num_threads, Atlas* atlas) {
  std::optional<TrackedFrame> before;
  const std::vector<PendingFrame> frames = pending_.TakeNewestFirst();
  for (const PendingFrame& frame : frames) {
    if (!frame.features) continue;
    Rigid3 predicted = last.world_from_camera;
    if (before) {
      predicted =
          last.world_from_camera * (before->world_from_camera.Inverse() * last.world_from_camera);
    }
    std::optional<TrackResult> result =
        TrackFromPrediction(*frame.features, predicted, last, local_, pixel_sigma_,
                            options_.tracker, std::nullopt, num_threads);
    if (!result) {
      result = TrackWithoutPrediction(*frame.features, local_, pixel_sigma_, options_.tracker,
                                      num_threads);
    }
    if (!result) continue;
    before = std::exchange(last, MakeTracked(frame, std::move(*result)));
    Anchor(last, atlas);
  }
  for (const PendingFrame& frame : frames) {
    if (!frame.turn || atlas->anchors().contains(frame.index)) continue;
    const auto reference = atlas->anchors().find(frame.turn->reference);
    if (reference == atlas->anchors().end()) continue;
    FrameAnchor turned = reference->second;
    turned.timestamp = frame.timestamp;
    turned.reference_from_camera.rotation =
        turned.reference_from_camera.rotation * frame.turn->reference_from_camera;
    turned.sightings.clear();
    atlas->Anchor(frame.index, std::move(turned));
  }
}

// Where something has covered the view for a moment, and the camera is found where its motion has
// taken it, it has been on the way in between. A frame that can be tracked backwards gets its own
// pose in place of this one.
void FrontEnd::InterpolatePending(const TrackedFrame& before, const TrackedFrame& after,
                                  Atlas* atlas) {
  const Rigid3 motion = before.world_from_camera.Inverse() * after.world_from_camera;
  const double elapsed = after.timestamp - before.timestamp;
  for (const PendingFrame& pending : pending_.frames()) {
    const double fraction = (pending.timestamp - before.timestamp) / elapsed;
    if (!(0 < fraction && fraction < 1)) continue;  // also for equal times
    const TrackedFrame frame{.index = pending.index,
                             .timestamp = pending.timestamp,
                             .features = pending.features,
                             .world_from_camera = before.world_from_camera *
                                                  Rigid3{ExpSo3(fraction * LogSo3(motion.rotation)),
                                                         fraction * motion.translation},
                             .landmarks = {}};
    Anchor(frame, atlas, true);
  }
}

}  // namespace orb360
