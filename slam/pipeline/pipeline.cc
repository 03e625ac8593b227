#include "slam/pipeline/pipeline.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <thread>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/pipeline/make_reconstruction.h"
#include "slam/pipeline/scale_state.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

int NumThreads(const Options& options) {
  if (options.num_threads > 0) return options.num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

Pipeline::Pipeline(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask)
    : camera_(camera),
      options_(options),
      num_threads_(NumThreads(options)),
      front_end_(camera, options, mask),
      atlas_(LoopDetector(options.loop, options.tracker, options.keyframe.local_keyframes,
                          front_end_.pixel_sigma())),
      back_end_(options) {}

void Pipeline::LoadMap(const StoredMap& stored, bool keeps_map) {
  ORB360_CHECK(num_frames_ == 0 && stored.map.num_keyframes() > 0, num_frames_);
  Map map = stored.map;
  // The frames of this run are numbered from 0, those of the stored map have negative numbers.
  int first_free = 0;
  for (const KeyframeId id : map.KeyframeIds()) {
    first_free = std::max(first_free, map.keyframe(id).frame_index + 1);
  }
  for (const KeyframeId id : map.KeyframeIds()) map.keyframe(id).frame_index -= first_free;
  atlas_.Begin(std::move(map));
  atlas_.SetGround(stored.ground);
  if (options_.loop.enabled) atlas_.places().Learn(atlas_.map(), atlas_.present_number());
  keeps_map_ = keeps_map;
  is_map_loaded_ = true;
  front_end_.StartLost(atlas_.map());
  CountMap();
}

void Pipeline::EnableDepth(const std::filesystem::path& weights,
                           const std::filesystem::path& folder, const nn::Device& device) {
  ORB360_CHECK(num_frames_ == 0 && !dense_, num_frames_);
  DepthOptions options = options_.depth;
  options.height = std::min(options.height, camera_.height());  // More would show nothing more.
  dense_.emplace(weights, folder, options, num_threads_, device);
}

FrameReport Pipeline::Process(const Frame& frame) {
  ORB360_CHECK(frame.image.type() == CV_8UC3 && frame.image.cols == camera_.width() &&
                   frame.image.rows == camera_.height(),
               frame.image.type(), frame.image.cols, frame.image.rows);
  FrameReport report;
  const Clock::time_point start = Clock::now();
  free_threads_ = FreeThreads();
  const PendingFrame pending =
      front_end_.Extract(frame.index, frame.timestamp, frame.image, free_threads_);
  report.timing_ms["extraction"] = MillisecondsSince(start);

  ++num_frames_;
  const Clock::time_point adoption = Clock::now();
  AdoptDue();
  report.timing_ms["adoption"] = MillisecondsSince(adoption);

  const Clock::time_point tracking = Clock::now();
  if (front_end_.tracking() != nullptr) {
    Track(pending);
  } else if (front_end_.lost() != nullptr) {
    Recover(pending);
  } else {
    Initialize(pending);
  }
  KeepImage(frame);
  if (watcher_) ShowState(frame, pending);
  StartDue(frame.image);
  report.timing_ms["tracking"] = MillisecondsSince(tracking);
  report.timing_ms["frame"] = MillisecondsSince(start);

  report.state = front_end_.state();
  if (const FrontEnd::Tracking* now = front_end_.tracking()) {
    report.state = TrackingState::kTracking;
    report.world_from_camera = now->last.world_from_camera;
    report.num_inliers = now->last.num_inliers;
  }
  report.map = atlas_.present_number();
  if (!atlas_.is_lent()) CountMap();
  report.num_keyframes = num_keyframes_;
  report.num_landmarks = num_landmarks_;
  return report;
}

void Pipeline::ShowState(const Frame& frame, const PendingFrame& pending) const {
  PresentState state{.frame = frame, .state = front_end_.state(), .features = *pending.features};
  if (const FrontEnd::Tracking* now = front_end_.tracking()) {
    state.landmarks = now->last.landmarks;
    state.map_from_camera = now->last.world_from_camera;
  }
  state.map_number = atlas_.present_number();
  if (!atlas_.is_lent()) state.map = &atlas_.map();
  state.ground = atlas_.ground();
  state.loops = atlas_.loops;
  watcher_(state);
}

void Pipeline::KeepImage(const Frame& frame) {
  if (!dense_) return;
  const FrontEnd::Tracking* now = front_end_.tracking();
  if (now == nullptr) {
    dense_->images().KeepUnplaced(frame.index, frame.image);
  } else {
    dense_->images().KeepTracked(frame.index, frame.image, now->last.world_from_camera,
                                 front_end_.local().median_range);
  }
}

void Pipeline::CountMap() {
  num_keyframes_ = atlas_.map().num_keyframes();
  num_landmarks_ = atlas_.map().num_landmarks();
}

// Each running job uses one core. OpenMP threads that wait for one without a core would cost more
// time than they save.
int Pipeline::FreeThreads() const {
  const bool is_mapping = back_end_.IsMapping() || (dense_ && dense_->completion().IsRunning());
  return std::max(1, num_threads_ - is_mapping - back_end_.IsAdjusting());
}

// --- tracking ---------------------------------------------------------------------------------

void Pipeline::Track(const PendingFrame& frame) {
  if (front_end_.Track(frame, free_threads_, &atlas_)) return;
  if (back_end_.has_map()) {
    AdoptMap();  // The newest landmarks may be sufficient to track the frame.
    if (front_end_.Track(frame, free_threads_, &atlas_)) return;
  }
  front_end_.Lose(frame, num_frames_, atlas_.map());
  atlas_.found_loop.reset();
  atlas_.places().Restart();
}

void Pipeline::Recover(const PendingFrame& frame) {
  if (std::optional<Relocalization> found = front_end_.Find(frame, free_threads_, &atlas_)) {
    if (found->map != atlas_.present_number()) {
      if (back_end_.is_adjusting()) AdoptAdjustment();
      front_end_.LeaveMap(&atlas_.map());
      if (dense_) dense_->ForgetGrounds();
      Apply(atlas_.SwitchTo(found->map, found->local.reference));
    }
    front_end_.Resume(frame, std::move(*found), free_threads_, &atlas_);
    return;
  }
  const int num_frames_lost = num_frames_ - front_end_.lost()->since;
  if (!keeps_map_ && num_frames_lost >= options_.recovery.patience_frames) {
    Initialize(frame);
  } else {
    front_end_.Remember(frame);
  }
}

void Pipeline::Initialize(const PendingFrame& frame) {
  std::optional<InitialMap> initial = front_end_.Initialize(frame, free_threads_);
  if (!initial) return;
  if (back_end_.is_adjusting()) AdoptAdjustment();
  if (dense_) dense_->ForgetGrounds();
  atlas_.Begin(std::move(initial->map));
  if (options_.loop.enabled) atlas_.places().Learn(atlas_.map(), atlas_.present_number());
  front_end_.StartTracking(*initial, free_threads_, &atlas_);
}

// --- result -----------------------------------------------------------------------------------

void Pipeline::CloseFoundLoop() {
  if (back_end_.is_adjusting()) AdoptAdjustment();
  if (!atlas_.found_loop) return;
  StartLoopCorrection();
  AdoptMap();
}

void Pipeline::FinishMap() {
  if (dense_ && dense_->completion().pending()) AdoptDepth();
  CloseFoundLoop();
  MapLastFrame();
  CloseFoundLoop();
  if (atlas_.loops.empty() && atlas_.merges.empty()) return;
  // This adjustment includes the keyframes after the last loop.
  if (!back_end_.is_adjusting()) StartAdjustment();
  AdoptAdjustment();
}

// Bundle adjustment weighs heights over planes of landmarks, which may be kerbs, as much as steps
// over the ground. All that the images show of the ground, together, knows the scale better, and so
// do positions.
void Pipeline::CorrectScale(const Positions& positions) {
  if (is_map_loaded_) return;  // Its unit of length is kept.
  const EstimatedScale scale =
      EstimateScale(atlas_.maps(), atlas_.grounds(), options_.scale, positions, atlas_.anchors());
  for (size_t i = 0; i < scale.maps.size(); ++i) {
    atlas_.ChangeUnit(static_cast<int>(i), std::exp(scale.maps[i].log_scale));
  }
}

ViewDepthReport Pipeline::ComputeDepth(const Reconstruction& finished,
                                       const ViewDepthCallbacks& callbacks) {
  return dense_ ? dense_->ComputeDepth(finished, atlas_.maps(), callbacks) : ViewDepthReport();
}

Reconstruction Pipeline::Finish(const Positions& positions) {
  for (const PositionFix& fix : positions.fixes)
    ORB360_CHECK(fix.IsValid(), fix.timestamp, fix.sigma);
  if (back_end_.has_map()) AdoptMap();
  if (!atlas_.is_lent()) FinishMap();  // Otherwise a job has thrown, and its map is lost.
  atlas_.Finish();
  if (dense_) dense_->Flush();

  CorrectScale(positions);
  Reconstruction result = MakeReconstruction(atlas_.maps(), atlas_.anchors(), num_threads_);
  std::span<const std::optional<KnownGround>> grounds = atlas_.grounds();
  // The ground of another place is better than none.
  if (!result.up && !grounds.empty() && grounds.front()) result.up = grounds.front()->up;
  const auto estimate = [&] {
    return EstimateScale(atlas_.maps(), grounds, options_.scale, positions, atlas_.anchors());
  };
  EstimatedScale scale = estimate();
  // A camera on its side takes a wall for the ground.
  std::optional<double> ground_probability;
  if (dense_ && result.up && scale.whole.state != ScaleState::kUnknown)
    ground_probability = dense_->GroundProbability(result, atlas_.maps(), *result.up);
  const std::vector<std::optional<KnownGround>> no_grounds(grounds.size());
  if (ground_probability && *ground_probability < kMinGroundProbability) {
    grounds = no_grounds;
    result.up.reset();
    scale = estimate();
  }
  scale.whole.ground_probability = ground_probability;
  for (size_t i = 0; i < result.maps.size(); ++i) {
    result.maps[i].is_metric = scale.maps[i].sigma > 0;
  }
  result.scale = std::move(scale.whole);
  result.keyframe_scales = std::move(scale.keyframes);
  const FrontEnd::Events& events = front_end_.events();
  result.initialized_at = events.initialized_at;
  result.lost = events.num_lost;
  result.relocalized = events.num_relocalized;
  result.loops = atlas_.loops;
  result.merges = atlas_.merges;
  return result;
}

}  // namespace orb360
