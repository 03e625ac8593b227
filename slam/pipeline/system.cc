#include "slam/pipeline/system.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "nn/base/check.h"
#include "slam/pipeline/ground.h"
#include "slam/pipeline/initializer.h"
#include "slam/pipeline/mapper.h"

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

// The ground as the newest keyframes see it: to be found at first, then to be followed uphill and
// downhill.
std::optional<KnownGround> LookForGround(const Map& map, const std::optional<KnownGround>& known,
                                         const ScaleOptions& options) {
  if (!options.from_ground) return std::nullopt;
  const std::vector<KeyframeId> keyframes = map.KeyframeIds();
  if (!known) {
    constexpr size_t kEnough = 5;  // keyframes
    if (keyframes.size() < kEnough) return std::nullopt;
    return EstimateGround(map, std::span(keyframes).last(kEnough));
  }
  constexpr double kShare = 0.2;  // of a new normal: roads bend slowly
  const std::optional<Eigen::Vector3d> normal = GroundNormal(map, keyframes.back(), known->up);
  if (!normal) return known;
  return KnownGround{((1 - kShare) * known->up + kShare * *normal).normalized(),
                     known->camera_height};
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
  Place(frame.index, frame.timestamp, last_.world_from_camera);
}

void System::Place(int index, double timestamp, const Rigid3& world_from_camera) {
  placements_[index] = {timestamp, static_cast<int>(finished_maps_.size()), local_.reference,
                        local_.world_from_reference.Inverse() * world_from_camera};
}

// --- recovery ---------------------------------------------------------------------------------

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
    Place(frame.index, frame.timestamp, result->world_from_camera);
    before = std::move(last);
    last = {frame.index,
            frame.timestamp,
            frame.features,
            result->world_from_camera,
            std::move(result->landmarks),
            result->num_inliers};
  }
  pending_.clear();
}

// --- initialization ---------------------------------------------------------------------------

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
        InitializeFromTwoViews(*reference->features, *frame.features, options_.initializer);
    if (result.map) {
      CreateMap(*reference, frame, *result.map);
      return;
    }
    if (result.failure == InitializationFailure::kLittleParallax) break;
    if (reference_index_ == pending_.back().index) break;
    reference_index_ = pending_.back().index;  // once more with the frame just before
  }
  Remember(frame);
}

void System::Remember(const PendingFrame& frame) {
  pending_.push_back(frame);
  if (static_cast<int>(pending_.size()) > options_.recovery.max_pending_frames) {
    pending_.pop_front();
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
  AdjustGlobally({.max_iterations = 20}, &map);

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
  Place(first.index, first.timestamp, map_.keyframe(keyframe1).world_from_camera);
  Place(second.index, second.timestamp, last_.world_from_camera);
  std::erase_if(pending_,
                [index = first.index](const PendingFrame& p) { return p.index == index; });
  TrackPendingBackwards(last_);
}

// --- mapping ----------------------------------------------------------------------------------

bool System::NeedsKeyframe() const {
  const KeyframeOptions& options = options_.keyframe;
  const double motion =
      (last_.world_from_camera.translation - local_.world_from_reference.translation).norm() /
      std::max(local_.median_range, 1e-12);
  if (motion < options.min_motion) return false;
  return motion > options.max_motion ||
         last_.num_inliers < options.min_tracked_share * local_.reference_matches ||
         last_.num_inliers < options.urgent_inliers;
}

void System::StartMapping() {
  TrackedFrame keyframe = last_;
  for (LandmarkId& id : keyframe.landmarks) id = map_.Resolve(id);
  std::optional<EquirectangularCamera> completed;  // the picture to be completed
  cv::Mat color;
  if (depth_ && depth_->Wants(map_.keyframe_end())) {
    completed = depth_->camera();
    cv::resize(image_, color, {completed->width(), completed->height()}, 0, 0, cv::INTER_AREA);
  }
  // The map moves into the job and comes back with its result; finished maps stay as they are while
  // there is a job.
  auto integrate = [map = std::move(map_), loops = std::move(loops_), finished = &finished_maps_,
                    keyframe, ground = ground_, completed, options = options_]() mutable {
    omp_set_num_threads(1);  // the other core goes on tracking
    const KeyframeId id = IntegrateKeyframe(keyframe, options.mapper, ground, &map);
    MappingResult result;
    result.reference = id;
    const Rigid3 correction =
        map.keyframe(id).world_from_camera * keyframe.world_from_camera.Inverse();
    result.correction = {1.0, correction.rotation, correction.translation};
    result.ground = LookForGround(map, ground, options.scale);
    if (completed) result.sparse = ProjectLandmarks(map, id, *completed, options.depth.sparse);
    if (options.loop.enabled) result.found = loops->Observe(map, id, *finished);
    result.map = std::move(map);
    result.loops = std::move(loops);
    return result;
  };
  map_ = Map();
  job_ = MappingJob{std::async(std::launch::async, std::move(integrate)), std::move(keyframe),
                    std::move(color), num_processed_ + options_.keyframe.mapping_frames};
}

// Depends on frames and matches only, never on whether the job is done: that would make results
// depend on the machine.
bool System::MustAdopt() const {
  const KeyframeOptions& options = options_.keyframe;
  return num_processed_ >= job_->adopt_at || last_.num_inliers < options.urgent_inliers ||
         last_.num_inliers < options.min_held_share * job_->frame.num_inliers;
}

void System::AdoptMapping() {
  MappingResult result = job_->result.get();
  const MappingJob job = std::move(*job_);
  job_.reset();
  map_ = std::move(result.map);
  loops_ = std::move(result.loops);
  if (!job.color.empty()) {
    if (depth_->is_pending()) AdoptCompletion();
    depth_->Start(map_.keyframe(result.reference), job.color, std::move(result.sparse),
                  num_processed_);
  }
  if (result.joined_map) AdoptJoinedMap(result);
  CountMap();
  // What was tracked meanwhile moves along with the keyframe.
  MoveTracked(result.correction);
  ScalePlacements(result.corrections);
  for (LandmarkId& landmark : last_.landmarks) landmark = map_.Resolve(landmark);
  CountSightings(&map_);
  if (result.found) loop_ = std::move(result.found);
  if (result.ground) FollowGround(*result.ground);
  local_ = MakeLocalMap(map_, result.reference, options_.keyframe.local_keyframes);
  if (result.closed) FollowCorrection(result);
}

void System::AdoptCompletion() {
  KeyframeDepth::Completed completed = depth_->Take();
  // It may have been removed, or be in another map by now.
  for (KeyframeId id = map_.keyframe_end() - 1; id >= 0; --id) {
    if (!map_.HasKeyframe(id) || map_.keyframe(id).frame_index != completed.frame_index) continue;
    Keyframe& keyframe = map_.keyframe(id);
    keyframe.range_priors = std::move(completed.priors);
    if (id == local_.reference) local_.provisional = MakeProvisionalPoints(keyframe);
    if (!ground_ && completed.ground) {
      completed.ground->up = keyframe.world_from_camera.rotation * completed.ground->up;
      dense_grounds_.push_back(*completed.ground);
    }
    return;
  }
}

void System::FollowGround(const KnownGround& ground) {
  if (!ground_) Rescale(options_.scale.height() / ground.camera_height);
  ground_ = {ground.up, options_.scale.height()};
}

// Where too few landmarks lie on the ground (a smooth floor, a hand before it), what dense depth
// shows of it is better than no metres at all.
void System::LookForDenseGround() {
  constexpr size_t kEnough = 10;      // keyframes
  constexpr double kMaxSigma = 0.05;  // of the logarithm of the height
  if (ground_ || !options_.scale.from_ground || dense_grounds_.size() < kEnough) return;
  const DenseGround fused = FuseGrounds(dense_grounds_).value();
  if (fused.sigma > kMaxSigma) return;
  FollowGround({fused.up, std::exp(fused.log_height)});
  local_ =
      MakeLocalMap(map_, map_.LivingKeyframe(local_.reference), options_.keyframe.local_keyframes);
}

// A change of gauge of the present map and of all that is relative to it; the place where the map
// began stays.
void System::Rescale(double factor) {
  if (bundle_) AdoptBundle();
  loop_.reset();  // measured in the unit before
  loops_->Restart();
  const Eigen::Vector3d center = map_.PoseOf(0).translation;
  const Similarity3 gauge{factor, Eigen::Quaterniond::Identity(), (1 - factor) * center};
  map_.Transform(gauge);
  MoveTracked(gauge);
  for (auto& [index, placement] : placements_) {
    const bool is_here = placement.map == static_cast<int>(finished_maps_.size());
    if (is_here) ScalePlacement(index, factor, &placement);
  }
}

void System::ScalePlacement(int frame_index, double factor, Placement* placement) {
  placement->reference_from_camera.translation *= factor;
  if (depth_) depth_->Rescale(frame_index, factor);
}

void System::FinishMap() {
  finished_maps_.push_back(std::move(map_));
  grounds_.push_back(ground_);
  map_ = Map();
  ground_.reset();
  dense_grounds_.clear();
}

void System::CountMap() {
  num_keyframes_ = map_.num_keyframes();
  num_landmarks_ = map_.num_landmarks();
}

void System::CountSightings(Map* map) {
  for (const LandmarkId id : expected_) {
    const LandmarkId now = map->Resolve(id);
    if (now != kNoId) ++map->landmark(now).visible;
  }
  for (const LandmarkId id : found_) {
    const LandmarkId now = map->Resolve(id);
    if (now != kNoId) ++map->landmark(now).found;
  }
  expected_.clear();
  found_.clear();
}

void System::UpdateLocalMap() {
  CountSightings(&map_);
  const std::vector<Map::Covisible> nearest = map_.FindCovisible(last_.landmarks, 1);
  if (nearest.empty() || nearest.front().keyframe == local_.reference) return;
  local_ = MakeLocalMap(map_, nearest.front().keyframe, options_.keyframe.local_keyframes);
}

// --- result -----------------------------------------------------------------------------------

Reconstruction System::Finish() {
  if (job_) AdoptMapping();
  if (depth_ && depth_->is_pending()) AdoptCompletion();
  if (bundle_) AdoptBundle();
  if (closed_loops_.size() + joints_.size() > 0) {
    StartBundle();  // what came after the last loop takes part as well
    AdoptBundle();
  }
  if (map_.num_keyframes() > 0) FinishMap();

  Reconstruction result = MakeReconstruction(finished_maps_, placements_);
  for (size_t i = 0; i < result.maps.size(); ++i) {
    result.maps[i].is_metric = grounds_[i].has_value();
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
