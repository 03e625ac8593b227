// System's part that maps keyframes and takes over what came of it.

#include <algorithm>
#include <cmath>
#include <utility>

#include <omp.h>
#include <opencv2/imgproc.hpp>

#include "slam/pipeline/ground.h"
#include "slam/pipeline/mapper.h"
#include "slam/pipeline/system.h"

namespace orb360 {
namespace {

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
                    picture = std::make_shared<const SpherePyramid>(extractor_.TakePyramid()),
                    keyframe, ground = ReliableGround(), completed, options = options_]() mutable {
    omp_set_num_threads(1);  // the other core goes on tracking
    const KeyframeId id =
        IntegrateKeyframe(keyframe, std::move(picture), options.mapper, ground, &map);
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

// As the landmarks show it.
std::optional<KnownGround> System::ReliableGround() const {
  return ground_ && !ground_->is_rough ? ground_ : std::nullopt;
}

void System::FollowGround(const KnownGround& ground) {
  if (!ReliableGround()) Rescale(options_.scale.height() / ground.camera_height);
  ground_ = {ground.up, options_.scale.height(), ground.is_rough};
}

// Where too few landmarks lie on the ground (a smooth floor, a hand before it), what dense depth
// shows of it is better than no metres at all.
void System::LookForDenseGround() {
  constexpr size_t kEnough = 10;      // keyframes
  constexpr double kMaxSigma = 0.05;  // of the logarithm of the height
  if (ground_ || !options_.scale.from_ground || dense_grounds_.size() < kEnough) return;
  const DenseGround fused = FuseGrounds(dense_grounds_).value();
  if (fused.sigma > kMaxSigma) return;
  FollowGround({fused.up, std::exp(fused.log_height), true});
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
  map_.ForgetPictures(0);
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

}  // namespace orb360
