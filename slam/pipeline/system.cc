#include "slam/pipeline/system.h"

#include <algorithm>
#include <chrono>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/check.h"

namespace orb360 {
namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

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

System::System(const EquirectangularCamera& camera, const Options& options, const cv::Mat& mask)
    : camera_(camera),
      options_(options),
      mask_(mask),
      extractor_(options.orb),
      pixel_sigma_(camera.AngleOfPixels(options.orb.pixel_sigma)),
      num_threads_(omp_get_max_threads()),
      loops_(LoopDetector(options.loop, options.tracker, options.keyframe.local_keyframes,
                          pixel_sigma_)) {}

System::~System() = default;

void System::CompleteKeyframes(DepthCompleter* completer, DepthSink sink) {
  depth_.emplace(completer, std::move(sink), options_);
}

FrameReport System::Process(const Frame& frame) {
  ORB360_CHECK(frame.image.type() == CV_8UC3 && frame.image.cols == camera_.width() &&
                   frame.image.rows == camera_.height(),
               frame.image.type(), frame.image.cols, frame.image.rows);
  omp_set_num_threads(FreeThreads());
  FrameReport report;
  const Clock::time_point start = Clock::now();
  cv::Mat gray;
  cv::cvtColor(frame.image, gray, cv::COLOR_BGR2GRAY);
  auto features = std::make_shared<Features>(extractor_.Extract(gray, mask_));
  SampleColors(frame.image, features.get());
  image_ = frame.image;
  report.timing_ms["extraction"] = MillisecondsSince(start);

  ++num_processed_;
  const Clock::time_point adoption = Clock::now();
  if (job_ && MustAdopt()) AdoptMapping();
  if (depth_ && !job_ && depth_->IsDue(num_processed_)) AdoptCompletion();
  if (bundle_ && !job_ && num_processed_ >= bundle_->adopt_at) AdoptBundle();
  if (!job_) LookForDenseGround();
  report.timing_ms["adoption"] = MillisecondsSince(adoption);

  const Clock::time_point tracking = Clock::now();
  const PendingFrame pending{frame.index, frame.timestamp, std::move(features)};
  switch (state_) {
    case TrackingState::kInitializing:
      InitializeMap(pending);
      break;
    case TrackingState::kTracking:
      TrackFrame(pending);
      break;
    case TrackingState::kLost:
      RecoverFrame(pending);
      break;
  }
  if (state_ == TrackingState::kTracking && !job_) {
    UpdateLocalMap();
    if (loop_ && !bundle_) {
      StartLoopCorrection();
    } else if (!keeps_map_ && NeedsKeyframe()) {
      StartMapping();
    }
  }
  report.timing_ms["tracking"] = MillisecondsSince(tracking);
  report.timing_ms["frame"] = MillisecondsSince(start);

  report.state = state_;
  if (state_ == TrackingState::kTracking) {
    report.world_from_camera = last_.world_from_camera;
    report.num_inliers = last_.num_inliers;
  }
  report.map = static_cast<int>(finished_maps_.size());
  if (!job_) CountMap();
  report.num_keyframes = num_keyframes_;
  report.num_landmarks = num_landmarks_;
  return report;
}

// Threads waiting for one that has no core cost more than they bring: each job has one.
int System::FreeThreads() const {
  const auto is_running = [](const auto& future) {
    return future.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  };
  const bool is_mapping = (job_ && is_running(job_->result)) || (depth_ && depth_->IsRunning());
  const bool is_adjusting = bundle_ && is_running(bundle_->adjusted);
  return std::max(1, num_threads_ - is_mapping - is_adjusting);
}

// --- tracking ---------------------------------------------------------------------------------

Rigid3 System::PredictPose(double timestamp) const {
  if (!before_last_) return last_.world_from_camera;
  const double elapsed = last_.timestamp - before_last_->timestamp;
  if (elapsed == 0) return last_.world_from_camera;
  // Constant velocity in the camera's frame.
  const double ratio = (timestamp - last_.timestamp) / elapsed;
  const Rigid3 motion = before_last_->world_from_camera.Inverse() * last_.world_from_camera;
  return last_.world_from_camera *
         Rigid3{ExpSo3(ratio * LogSo3(motion.rotation)), ratio * motion.translation};
}

void System::TrackFrame(const PendingFrame& frame) {
  const auto track = [&] {
    std::optional<TrackResult> result =
        TrackFromPrediction(*frame.features, PredictPose(frame.timestamp), last_, local_,
                            pixel_sigma_, options_.tracker);
    if (!result) {
      result = TrackWithoutPrediction(*frame.features, local_, pixel_sigma_, options_.tracker);
    }
    return result;
  };
  std::optional<TrackResult> result = track();
  if (!result && job_) {
    AdoptMapping();  // the newest landmarks may save the day
    result = track();
  }
  if (result) {
    AcceptTracking(frame, std::move(*result));
    return;
  }
  state_ = TrackingState::kLost;
  ++num_lost_;
  lost_since_ = num_processed_;
  relocalization_cursor_ = map_.keyframe_end() - 1;
  reference_index_ = -1;
  loop_.reset();
  loops_->Restart();
  pending_.push_back(frame);
}

void System::AcceptTracking(const PendingFrame& frame, TrackResult result) {
  expected_.insert(expected_.end(), result.expected.begin(), result.expected.end());
  std::copy_if(result.landmarks.begin(), result.landmarks.end(), std::back_inserter(found_),
               [](LandmarkId id) { return id != kNoId; });
  before_last_ = std::move(last_);
  last_ = {frame.index,
           frame.timestamp,
           frame.features,
           result.world_from_camera,
           std::move(result.landmarks),
           result.num_inliers};
  Place(last_);
}

void System::Place(const TrackedFrame& frame) {
  placements_[frame.index] = {
      frame.timestamp, static_cast<int>(finished_maps_.size()), local_.reference,
      local_.world_from_reference.Inverse() * frame.world_from_camera, SightingsOf(frame)};
}

// --- result -----------------------------------------------------------------------------------

Reconstruction System::Finish() {
  if (job_) AdoptMapping();
  if (depth_ && depth_->is_pending()) AdoptCompletion();
  if (depth_) depth_->Flush();
  if (bundle_) AdoptBundle();
  if (loop_) {  // found by the last keyframe
    StartLoopCorrection();
    AdoptMapping();
  }
  if (closed_loops_.size() + joints_.size() > 0) {
    if (!bundle_) StartBundle();  // what came after the last loop takes part as well
    AdoptBundle();
  }
  if (map_.num_keyframes() > 0) FinishMap();

  Reconstruction result = MakeReconstruction(finished_maps_, placements_);
  for (size_t i = 0; i < result.maps.size(); ++i) {
    result.maps[i].is_metric = grounds_[i].has_value();
    result.maps[i].is_rough = grounds_[i] && grounds_[i]->is_rough;
  }
  // Better the ground of another place than none.
  if (!result.up && !grounds_.empty() && grounds_.front()) result.up = grounds_.front()->up;
  result.initialized_at = initialized_at_;
  if (depth_) result.depth_scales = depth_->scales();
  result.lost = num_lost_;
  result.relocalized = num_relocalized_;
  result.loops = closed_loops_;
  result.joints = joints_;
  return result;
}

}  // namespace orb360
