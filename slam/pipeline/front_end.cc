#include "slam/pipeline/front_end.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/ground_steps.h"

namespace orb360 {
namespace {

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
  pyramid_of_ = index;
  return {.index = index, .timestamp = timestamp, .features = std::move(features)};
}

// --- tracking ---------------------------------------------------------------------------------

Rigid3 FrontEnd::PredictPose(const Tracking& tracking, double timestamp) {
  const TrackedFrame& last = tracking.last;
  if (!tracking.before_last) return last.world_from_camera;
  const double elapsed = last.timestamp - tracking.before_last->timestamp;
  if (elapsed == 0) return last.world_from_camera;
  const double ratio = (timestamp - last.timestamp) / elapsed;
  const Rigid3 motion = tracking.before_last->world_from_camera.Inverse() * last.world_from_camera;
  return last.world_from_camera *
         Rigid3{ExpSo3(ratio * LogSo3(motion.rotation)), ratio * motion.translation};
}

TrackedFrame FrontEnd::MakeTracked(const PendingFrame& frame, TrackResult result) {
  return {.index = frame.index,
          .timestamp = frame.timestamp,
          .features = frame.features,
          .world_from_camera = result.world_from_camera,
          .landmarks = std::move(result.landmarks),
          .num_inliers = result.num_inliers};
}

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

double FrontEnd::Motion() const {
  const Rigid3& pose = std::get<Tracking>(state_).last.world_from_camera;
  return (pose.translation - local_.world_from_reference.translation).norm() /
         std::max(local_.median_range, 1e-12);
}

bool FrontEnd::HasMoved(bool has_ground) const {
  // Where all landmarks are far, a step that the ground shows is little beside their range.
  constexpr double kMinGroundStep = 0.1;  // heights of the camera (GroundSweepOptions)
  return Motion() >= options_.keyframe.min_motion ||
         (has_ground && Motion() * local_.median_range >= kMinGroundStep * options_.scale.height());
}

bool FrontEnd::NeedsKeyframe(const Map& map, bool has_ground) const {
  const TrackedFrame& last = std::get<Tracking>(state_).last;
  const KeyframeOptions& options = options_.keyframe;
  const double motion = Motion();
  // The next step over the ground would be too long to be measured (GroundSweepOptions).
  constexpr double kMaxGroundStep = 2.5;  // heights of the camera
  if (has_ground && motion * local_.median_range > kMaxGroundStep * options_.scale.height()) {
    return true;
  }
  if (motion < options.min_motion) return false;
  // Before the ground is known, nobody knows how long a step is. Carriers move by a fraction of the
  // camera's height to three heights in this time.
  constexpr double kMaxStepTime = 0.25;  // seconds
  if (options_.scale.from_ground && SeeksGround(map, has_ground) &&
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
  const TrackedFrame first = orb360::MakeTracked(map.keyframe(InitialMap::kFirst));
  const TrackedFrame second = orb360::MakeTracked(map.keyframe(InitialMap::kSecond));
  state_ = Tracking{.last = second, .before_last = first};
  Anchor(first, atlas);
  Anchor(second, atlas);
  pending_.Forget(initial.first.index);
  TrackPendingBackwards(second, num_threads, atlas);
}

}  // namespace orb360
