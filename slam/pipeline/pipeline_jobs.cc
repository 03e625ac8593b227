// The jobs that run beside tracking: when they start, and how their results are adopted.

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/ground_steps.h"
#include "slam/pipeline/pipeline.h"

namespace orb360 {

void Pipeline::AdoptDue() {
  const FrontEnd::Tracking* tracking = front_end_.tracking();
  const int num_inliers = tracking == nullptr ? 0 : tracking->last.num_inliers;
  if (back_end_.IsMapDue(num_frames_, num_inliers)) AdoptMap();
  if (back_end_.has_map()) return;
  if (dense_ && dense_->completion().IsDue(num_frames_)) AdoptDepth();
  if (back_end_.IsAdjustmentDue(num_frames_)) AdoptAdjustment();
  LookForDenseGround();
}

void Pipeline::StartDue(const cv::Mat& image) {
  if (front_end_.tracking() == nullptr || back_end_.has_map()) return;
  front_end_.UpdateLocalMap(&atlas_.map());
  if (atlas_.found_loop && !back_end_.is_adjusting()) {
    StartLoopCorrection();
  } else if (!keeps_map_ &&
             front_end_.NeedsKeyframe(atlas_.map(), atlas_.ReliableGround().has_value())) {
    StartMapping(image);
  }
}

void Pipeline::Apply(const MapUpdate& update) {
  atlas_.Apply(update);
  front_end_.Apply(update, &atlas_.map());
}

// --- mapping of keyframes -----------------------------------------------------------------------

// Frames between keyframes are held by both. After the last keyframe nothing would hold them.
void Pipeline::MapLastFrame() {
  if (keeps_map_ || front_end_.tracking() == nullptr || !front_end_.HasPyramid()) return;
  front_end_.UpdateLocalMap(&atlas_.map());
  if (!front_end_.HasMoved(atlas_.ReliableGround().has_value())) return;
  StartMapping({});
  AdoptMap();
}

void Pipeline::StartMapping(const cv::Mat& image) {
  TrackedFrame frame = front_end_.tracking()->last;
  for (LandmarkId& id : frame.landmarks) id = atlas_.map().Resolve(id);
  if (dense_ && !image.empty()) dense_->images().KeepKeyframe(frame.index, image);
  const std::optional<KnownGround> ground = atlas_.ReliableGround();
  // The sooner a keyframe is in the map, the sooner there is the next one.
  const bool seeks_ground =
      options_.scale.from_ground && SeeksGround(atlas_.map(), ground.has_value());
  KeyframeMapping job{.active = atlas_.Lend(),
                      .finished = atlas_.finished(),
                      .frame = std::move(frame),
                      .pyramid = std::make_shared<const SpherePyramid>(front_end_.TakePyramid()),
                      .ground = ground,
                      .mask = front_end_.mask()};
  if (dense_ && !image.empty() && options_.depth.guides_mapping) {
    job.completed_camera = dense_->camera();
    cv::resize(image, job.color, {dense_->camera().width(), dense_->camera().height()}, 0, 0,
               cv::INTER_AREA);
  }
  const KeyframeOptions& options = options_.keyframe;
  const AdoptionTime adoption{
      .num_frames = num_frames_ + (seeks_ground ? 1 : options.mapping_frames),
      .min_inliers = std::max<double>(options.urgent_inliers,
                                      options.min_held_fraction * job.frame.num_inliers)};
  back_end_.Start(std::move(job), adoption);
}

void Pipeline::AdoptMap() {
  std::visit([this](auto&& result) { Adopt(std::forward<decltype(result)>(result)); },
             back_end_.TakeMap());
}

void Pipeline::Adopt(MappedKeyframe mapped) {
  atlas_.Return(std::move(mapped.active));
  CountMap();
  Apply(mapped.update);
  front_end_.SetGroundMotion(mapped.ground_motion);
  if (!mapped.color.empty()) {
    if (dense_->completion().pending()) AdoptDepth();
    dense_->completion().Start(atlas_.map().keyframe(mapped.update.reference), mapped.color,
                               std::move(mapped.sparse), num_frames_);
  }
  if (mapped.loop) atlas_.found_loop = std::move(mapped.loop);
  if (mapped.ground) FollowGround(*mapped.ground, mapped.changes_unit);
}

// --- depth --------------------------------------------------------------------------------------

void Pipeline::AdoptDepth() {
  const int frame_index = dense_->completion().pending().value();
  CompletedKeyframe completed =
      dense_->completion().Take(atlas_.anchors().at(frame_index).unit_scale);
  // The keyframe may have been removed, or belong to another map by now.
  Map& map = atlas_.map();
  for (KeyframeId id = map.keyframe_end() - 1; id >= 0; --id) {
    if (!map.HasKeyframe(id) || map.keyframe(id).frame_index != frame_index) continue;
    Keyframe& keyframe = map.keyframe(id);
    keyframe.range_priors = std::move(completed.priors);
    front_end_.UseDepth(keyframe);
    if (!atlas_.ground() && completed.ground) {
      completed.ground->up = keyframe.world_from_camera.rotation * completed.ground->up;
      dense_->AddGround(*completed.ground);
    }
    return;
  }
}

// --- loops --------------------------------------------------------------------------------------

void Pipeline::StartLoopCorrection() {
  const FrontEnd::Tracking* tracking = front_end_.tracking();
  const int num_inliers = tracking == nullptr ? 0 : tracking->last.num_inliers;
  const KeyframeOptions& options = options_.keyframe;
  const AdoptionTime adoption{.num_frames = num_frames_ + options_.loop.correction_frames,
                              .min_inliers = std::max<double>(
                                  options.urgent_inliers, options.min_held_fraction * num_inliers)};
  const KeyframeId reference = atlas_.map().LivingKeyframe(front_end_.local().reference);
  back_end_.Start(LoopCorrection{.active = atlas_.Lend(),
                                 .finished = atlas_.finished(),
                                 .loop = std::exchange(atlas_.found_loop, std::nullopt).value(),
                                 .reference = reference},
                  adoption);
}

void Pipeline::Adopt(CorrectedLoop corrected) {
  const MapUpdate& update = corrected.update;
  atlas_.Return(std::move(corrected.active));
  CountMap();
  Apply(update);
  if (!corrected.closed) return;
  (update.renumbering ? atlas_.merges : atlas_.loops).push_back(*corrected.closed);
  if (atlas_.ground()) {
    KnownGround ground = *atlas_.ground();
    ground.up = update.correction.rotation * ground.up;
    atlas_.SetGround(ground);
  }
  if (dense_) dense_->ForgetGrounds();  // The unit of length may have changed.
  StartAdjustment();
}

void Pipeline::StartAdjustment() {
  GlobalAdjustment job{.map = atlas_.map(), .ground = atlas_.ReliableGround()};
  job.map.ForgetImages(0);
  const double frames = options_.loop.bundle_frames * job.map.num_keyframes();
  back_end_.Start(std::move(job),
                  {.num_frames = num_frames_ + static_cast<int>(std::ceil(frames))});
}

void Pipeline::AdoptAdjustment() {
  const AdjustedMap adjusted = back_end_.TakeAdjusted();
  Apply(TakeOver(adjusted, front_end_.local().reference, &atlas_.map()));
}

// --- the ground ---------------------------------------------------------------------------------

void Pipeline::FollowGround(const KnownGround& ground, bool changes_unit) {
  const double height = options_.scale.height();
  if (changes_unit) {
    if (back_end_.is_adjusting()) AdoptAdjustment();
    atlas_.found_loop.reset();  // It was measured in the old unit of length.
    atlas_.places().Restart();
    Apply(RescaleMap(height / ground.camera_height, front_end_.local().reference, &atlas_.map()));
  }
  atlas_.SetGround(
      KnownGround{.up = ground.up, .camera_height = height, .is_rough = ground.is_rough});
}

// Where too few landmarks lie on the ground, for example on a smooth floor or behind a hand, the
// ground in the dense depth makes the map at least roughly metric.
void Pipeline::LookForDenseGround() {
  if (!dense_ || atlas_.ground() || !options_.scale.from_ground) return;
  if (const std::optional<KnownGround> ground = dense_->Ground()) {
    FollowGround(*ground, true);
  }
}

}  // namespace orb360
