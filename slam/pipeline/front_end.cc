#include "slam/pipeline/front_end.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/ground_steps.h"

namespace orb360 {
namespace {

// Time for which a motion predicts where the camera is, seconds.
constexpr double kPredictable = 1.0;

void SampleColors(const cv::Mat& bgr, Features* features) {
  features->colors.resize(features->size());
  for (int i = 0; i < features->size(); ++i) {
    const Eigen::Vector2f& pixel = features->keypoints[i].pixel;
    const cv::Vec3b& c =
        bgr.at<cv::Vec3b>(std::clamp(static_cast<int>(pixel.y()), 0, bgr.rows - 1),
                          std::clamp(static_cast<int>(pixel.x()), 0, bgr.cols - 1));
    features->colors[i] = {c[2], c[1], c[0]};
  }
}

/// Predicts the pose at a time (seconds) with constant velocity in the camera's frame.
Rigid3 PredictPose(const FrontEnd::Tracking& tracking, double timestamp) {
  const TrackedFrame& last = tracking.last;
  if (!tracking.before_last) return last.world_from_camera;
  const double elapsed = last.timestamp - tracking.before_last->timestamp;
  if (elapsed == 0) return last.world_from_camera;
  const double ratio = (timestamp - last.timestamp) / elapsed;
  const Rigid3 motion = tracking.before_last->world_from_camera.Inverse() * last.world_from_camera;
  return last.world_from_camera *
         Rigid3{ExpSo3(ratio * LogSo3(motion.rotation)), ratio * motion.translation};
}

TrackedFrame MakeTracked(const PendingFrame& frame, TrackResult result) {
  return {.index = frame.index,
          .timestamp = frame.timestamp,
          .features = frame.features,
          .world_from_camera = result.world_from_camera,
          .landmarks = std::move(result.landmarks),
          .num_inliers = result.num_inliers};
}

}  // namespace

FrontEnd::FrontEnd(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask)
    : options_(options),
      mask_(mask),
      pixel_sigma_(camera.AngleOfPixels(options.orb.pixel_sigma)),
      extractor_(options.orb),
      pending_(options.recovery.max_pending_frames) {}

PendingFrame FrontEnd::Extract(int index, double timestamp, const cv::Mat& image, int num_threads) {
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  auto features = std::make_shared<Features>(extractor_.Extract(gray, mask_, num_threads));
  SampleColors(image, features.get());
  return {.index = index, .timestamp = timestamp, .features = std::move(features)};
}

// --- tracking ---------------------------------------------------------------------------------

bool FrontEnd::Track(const PendingFrame& frame, int num_threads, Atlas* atlas) {
  Tracking& tracking = std::get<Tracking>(state_);
  Rigid3 predicted = PredictPose(tracking, frame.timestamp);
  std::optional<PositionPrior> prior;
  if (ground_motion_ && frame.timestamp - ground_motion_->timestamp < kPredictable) {
    prior = PredictPosition(*ground_motion_, frame.timestamp, predicted.rotation);
    if (prior) predicted.translation = prior->position;
  }
  std::optional<TrackResult> result =
      TrackFromPrediction(*frame.features, predicted, tracking.last, local_, pixel_sigma_,
                          options_.tracker, prior, num_threads);
  if (!result) {
    result = TrackWithoutPrediction(*frame.features, local_, pixel_sigma_, options_.tracker,
                                    num_threads);
  }
  if (!result) return false;
  counts_.Add(*result);
  tracking.before_last = std::exchange(tracking.last, MakeTracked(frame, std::move(*result)));
  Anchor(tracking.last, atlas);
  return true;
}

void FrontEnd::Anchor(const TrackedFrame& frame, Atlas* atlas, bool is_interpolated) const {
  atlas->Anchor(frame.index, {.timestamp = frame.timestamp,
                              .map = atlas->present_number(),
                              .reference = local_.reference,
                              .reference_from_camera =
                                  local_.world_from_reference.Inverse() * frame.world_from_camera,
                              .sightings = SightingsOf(frame),
                              .is_interpolated = is_interpolated});
}

bool FrontEnd::NeedsKeyframe(const Map& map, bool has_ground) const {
  const TrackedFrame& last = std::get<Tracking>(state_).last;
  const KeyframeOptions& options = options_.keyframe;
  const double motion =
      (last.world_from_camera.translation - local_.world_from_reference.translation).norm() /
      std::max(local_.median_range, 1e-12);
  // The next step over the ground would be too long to be measured (GroundSweepOptions).
  constexpr double kMaxGroundStep = 2.5;  // heights of the camera
  if (has_ground && motion * local_.median_range > kMaxGroundStep * options_.scale.height()) {
    return true;
  }
  if (motion < options.min_motion) return false;
  // Before the ground is known, nobody knows how long a step is. Carriers move by a fraction of the
  // camera's height to three heights in this time.
  constexpr double kMaxStepTime = 0.25;  // seconds
  if (options_.scale.from_ground && !has_ground && map.keyframe_end() < kGroundSearch &&
      last.timestamp - map.keyframe(map.LivingKeyframe(map.keyframe_end() - 1)).timestamp >
          kMaxStepTime) {
    return true;
  }
  return motion > options.max_motion ||
         last.num_inliers < options.min_tracked_fraction * local_.reference_matches ||
         last.num_inliers < options.urgent_inliers;
}

void FrontEnd::UpdateLocalMap(Map* map) {
  counts_.MoveTo(map);
  const std::vector<Map::Covisible> nearest =
      map->FindCovisible(std::get<Tracking>(state_).last.landmarks, 1);
  if (nearest.empty() || nearest.front().keyframe == local_.reference) return;
  local_ = MakeLocalMap(*map, nearest.front().keyframe, options_.keyframe.local_keyframes);
}

void FrontEnd::UseDepth(const Keyframe& keyframe) {
  if (keyframe.id == local_.reference) local_.provisional = MakeProvisionalPoints(keyframe);
}

void FrontEnd::Apply(const MapUpdate& update, Map* map) {
  const LandmarkId shift = update.renumbering ? update.renumbering->landmark_shift : 0;
  const auto move = [&](Rigid3* pose) { *pose = TransformPose(update.correction, *pose); };
  auto* tracking = std::get_if<Tracking>(&state_);
  if (auto* lost = std::get_if<Lost>(&state_); lost && lost->before) tracking = &*lost->before;
  if (tracking != nullptr) {
    move(&tracking->last.world_from_camera);
    if (tracking->before_last) move(&tracking->before_last->world_from_camera);
    for (LandmarkId& id : tracking->last.landmarks) {
      if (id != kNoId) id = map->Resolve(id + shift);
    }
  }
  if (ground_motion_) {
    move(&ground_motion_->world_from_camera);
    ground_motion_->velocity *= update.correction.scale;
  }
  counts_.Shift(shift);
  counts_.MoveTo(map);
  local_ = MakeLocalMap(*map, update.reference, options_.keyframe.local_keyframes);
}

// --- recovery ---------------------------------------------------------------------------------

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

// --- initialization -----------------------------------------------------------------------------

std::optional<InitialMap> FrontEnd::Initialize(PendingFrame frame, int num_threads) {
  frame.image = std::make_shared<const SpherePyramid>(TakePyramid());
  constexpr int kAttempts = 2;  // with the reference, then with the frame before this one
  for (int attempt = 0; attempt < kAttempts && !pending_.empty(); ++attempt) {
    const PendingFrame& reference = pending_.Reference();
    const InitializationResult result =
        InitializeFromTwoViews(*reference.features, *frame.features, options_.initializer,
                               options_.mapper.bundle.optimizer, num_threads);
    if (result.map) {
      InitialMap initial = MakeInitialMap(reference, frame, *result.map, options_.mapper);
      // The gauge: the median range of the landmarks is one unit of length.
      Similarity3 gauge;
      gauge.scale = 1.0 / initial.map.MedianRange(InitialMap::kSecond);
      if (const Lost* before = lost()) {
        gauge.scale *= local_.median_range;
        const Rigid3 last = before->before ? before->before->last.world_from_camera : Rigid3{};
        gauge.rotation = last.rotation;
        gauge.translation = last.translation;
      }
      initial.map.Transform(gauge);
      if (!events_.initialized_at) events_.initialized_at = frame.index;
      return initial;
    }
    if (result.failure == InitializationFailure::kLittleParallax) {
      PendingFrame turned = frame;
      turned.turn = {reference.index, *result.turn};
      pending_.Remember(std::move(turned));
      return std::nullopt;
    }
    if (!pending_.AdvanceReference()) break;
  }
  pending_.Remember(frame);
  return std::nullopt;
}

void FrontEnd::StartTracking(const InitialMap& initial, int num_threads, Atlas* atlas) {
  const Map& map = atlas->map();
  local_ = MakeLocalMap(map, InitialMap::kSecond, options_.keyframe.local_keyframes);
  counts_.Clear();
  const TrackedFrame first = MakeTracked(map.keyframe(InitialMap::kFirst));
  const TrackedFrame second = MakeTracked(map.keyframe(InitialMap::kSecond));
  state_ = Tracking{.last = second, .before_last = first};
  Anchor(first, atlas);
  Anchor(second, atlas);
  pending_.Forget(initial.first.index);
  TrackPendingBackwards(second, num_threads, atlas);
}

}  // namespace orb360
