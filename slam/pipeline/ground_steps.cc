#include "slam/pipeline/ground_steps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/features/sphere_pyramid.h"
#include "slam/pipeline/lens_distance.h"
#include "slam/pipeline/retriangulation.h"
#include "slam/scale/ground_sweep.h"

namespace orb360 {
namespace {

// Number of earlier keyframes from which the step is measured.
constexpr int kSources = 2;
// Standard deviation of ln(step) of a tracked pose in good conditions, and the number of standard
// deviations from which the ground overrules it.
constexpr double kTrackedSigma = 0.01;
constexpr double kMaxSigmas = 3.0;
// Standard deviation of the turn of a tracked pose about the vertical in good conditions, rad.
constexpr double kTrackedTurnSigma = 0.002;
// Largest standard deviation of a turn that is used, rad. On boards, whose grain is the same all
// along, tiles scatter across the motion, and the tracked rotation is better.
constexpr double kMaxTurnSigma = 0.01;
// The speed changes from one step to the next by up to this factor, or where that is more, as after
// a halt, by this acceleration, heights of the camera per s^2 (cars brake with 8 m/s^2). Both hold
// if not more than kMaxGap passes, seconds.
constexpr double kMaxSpeedChange = 1.6;
constexpr double kMaxAcceleration = 4.0;
constexpr double kMaxGap = 5.0;
// The longer of two steps that contradict each other by more than this is dropped: the ground that
// both images see is less, and its texture may repeat.
constexpr double kMaxMisclosure = 0.2;
// The direction of motion may be wrong by this much of the step, heights of the camera, as long as
// nothing has told about the ground: few near landmarks have been seen by then.
constexpr double kWideAside = 0.96;

// A measured step, the time half-way, and the time that it took, seconds.
struct TimedStep {
  const GroundStepFrom* step;
  double timestamp;
  double elapsed;
};

// The newest step up to a keyframe, or else the first one after it, if that is not long before or
// after.
std::optional<TimedStep> StepNear(const Map& map, const Keyframe& keyframe) {
  for (const int direction : {-1, 1}) {
    for (KeyframeId id = keyframe.id; id >= 0 && id < map.keyframe_end(); id += direction) {
      if (!map.HasKeyframe(id)) continue;
      const Keyframe& other = map.keyframe(id);
      if (!other.IsOfThisRun()) break;
      if (!(std::abs(keyframe.timestamp - other.timestamp) < kMaxGap)) break;
      for (const GroundStepFrom& step : other.ground_steps) {
        if (!map.HasKeyframe(step.keyframe)) continue;
        const double elapsed = other.timestamp - map.keyframe(step.keyframe).timestamp;
        if (elapsed > 0) return TimedStep{&step, other.timestamp - 0.5 * elapsed, elapsed};
      }
    }
  }
  return std::nullopt;
}

// The range in which the step from one keyframe to another is sought: around what the speed of the
// last step lets expect, or else tracking. Textures repeat, in rendered worlds more than in others,
// so that a step beyond the range may look like a short one. Empty where the step is too long or
// too short.
std::optional<GroundSweepOptions> RangeOfSweep(const Map& map, const Keyframe& earlier,
                                               const Keyframe& later,
                                               const std::optional<KnownGround>& ground) {
  GroundSweepOptions options{.lens_distance = AssumedLensDistance(map)};
  if (!ground) options.max_aside = kWideAside;
  double expected = 0;  // ratio
  double change = 0;    // of the ratio, by acceleration
  if (const std::optional<TimedStep> near = StepNear(map, earlier)) {
    const double elapsed = later.timestamp - earlier.timestamp;
    const double between = std::abs(earlier.timestamp + 0.5 * elapsed - near->timestamp);
    expected = near->step->ratio / near->elapsed * elapsed;
    change = kMaxAcceleration * between * elapsed;
  } else if (ground) {
    expected =
        (later.world_from_camera.translation - earlier.world_from_camera.translation).norm() /
        ground->camera_height;
  } else {
    return options;
  }
  if (!(expected < options.max_ratio)) return std::nullopt;
  options.min_ratio =
      std::max(options.min_ratio, std::min(expected / kMaxSpeedChange, expected - change));
  options.max_ratio =
      std::min(options.max_ratio, std::max(expected * kMaxSpeedChange, expected + change));
  if (!(options.min_ratio < options.max_ratio)) return std::nullopt;
  return options;
}

// A carrier stands on the ground and drives ahead, so that both directions change little in the
// frame of the camera. They are tried where tracking may be wrong about the motion, as it is beside
// another car, and about the ground.
std::vector<GroundStepGuess> GuessesOf(const Map& map, const Keyframe& earlier,
                                       const Rigid3& motion,
                                       const std::optional<KnownGround>& ground) {
  const Eigen::Vector3d known_up = ground
                                       ? earlier.world_from_camera.rotation.conjugate() * ground->up
                                       : Eigen::Vector3d::UnitZ();
  const std::optional<TimedStep> near = StepNear(map, earlier);
  if (!near) return {{motion.translation, known_up}};
  const GroundStepFrom& step = *near->step;
  return {
      {motion.translation, step.up}, {step.direction2, step.up}, {motion.translation, known_up}};
}

// Standard deviation of ln(step) on ground that slopes by an angle: its height over a point
// straight below is that of somebody who carries the camera, and its distance from the plane that
// of a vehicle. Nobody knows which of both is given; they differ by the factor cos(angle). `up`:
// normal of the ground, camera frame. Of all the ground of this run, that along which the camera is
// most upright is taken to be level: cameras are held upright, or always tilted alike. Up to 8
// degrees it is the measured normal that is uncertain rather than the ground that slopes.
double SlopeSigma(const Map& map, const Eigen::Vector3d& up) {
  double level = up.z();
  for (const KeyframeId id : map.KeyframeIds()) {
    const Keyframe& keyframe = map.keyframe(id);
    if (!keyframe.IsOfThisRun()) continue;
    for (const GroundStepFrom& step : keyframe.ground_steps) level = std::max(level, step.up.z());
  }
  constexpr double kUncertain = 0.01;  // of the cosine
  return std::max(0.0, level - up.z() - kUncertain);
}

}  // namespace

void MeasureGroundSteps(KeyframeId id, const std::optional<KnownGround>& ground,
                        const cv::Mat& mask, Map* map) {
  Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.image) return;
  int num_sources = 0;
  for (KeyframeId other = id - 1; other >= 0 && num_sources < kSources; --other) {
    if (!map->HasKeyframe(other)) continue;
    ++num_sources;
    const Keyframe& earlier = map->keyframe(other);
    if (!earlier.image) break;
    const Rigid3& pose = earlier.world_from_camera;
    const Rigid3 motion = pose.Inverse() * keyframe.world_from_camera;
    const std::optional<GroundSweepOptions> options = RangeOfSweep(*map, earlier, keyframe, ground);
    if (!options) continue;
    const std::optional<GroundStep> step =
        MeasureGroundStep(*earlier.image, *keyframe.image, motion.rotation,
                          GuessesOf(*map, earlier, motion, ground), mask, *options);
    if (!step) continue;
    const Eigen::Vector3d half = 0.5 * step->ratio * step->direction;
    const Eigen::Vector3d up =
        (step->up - step->up.dot(step->direction) * step->direction).normalized();
    const Eigen::Quaterniond later_from_earlier = motion.rotation.conjugate();
    const Eigen::Vector3d seen_up = later_from_earlier * step->up;
    const double turn = step->turn_sigma < kMaxTurnSigma ? step->turn : 0.0;
    const Eigen::Quaterniond turned = later_from_earlier * ExpSo3(-turn * up);
    keyframe.ground_steps.push_back({.keyframe = other,
                                     .ratio = step->ratio,
                                     .sigma = std::hypot(step->sigma, SlopeSigma(*map, seen_up)),
                                     .point1 = half - up,
                                     .point2 = later_from_earlier * (-half - up),
                                     .direction1 = step->direction,
                                     .direction2 = turned * step->direction,
                                     .turn_sigma = step->turn_sigma,
                                     .up = seen_up,
                                     .assumed_lens_distance = options->lens_distance,
                                     .per_lens_distance = step->per_lens_distance,
                                     .lens_distance = step->lens_distance});
  }
  const std::optional<double> misclosure = MisclosureOfSteps(*map, id);
  if (misclosure && *misclosure > kMaxMisclosure) keyframe.ground_steps.pop_back();
}

std::optional<double> MisclosureOfSteps(const Map& map, KeyframeId id) {
  const std::vector<GroundStepFrom>& steps = map.keyframe(id).ground_steps;
  if (steps.size() < 2) return std::nullopt;
  const GroundStepFrom& last = steps[0];
  const GroundStepFrom& both = steps[1];
  if (!map.HasKeyframe(last.keyframe) || !map.HasKeyframe(both.keyframe)) return std::nullopt;
  const std::vector<GroundStepFrom>& steps_before = map.keyframe(last.keyframe).ground_steps;
  const auto first = std::ranges::find(steps_before, both.keyframe, &GroundStepFrom::keyframe);
  if (first == steps_before.end()) return std::nullopt;
  // In the frame of the keyframe in between.
  const Eigen::Quaterniond between_from_before =
      map.PoseOf(last.keyframe).rotation.conjugate() * map.PoseOf(both.keyframe).rotation;
  const Eigen::Vector3d sum = first->ratio * first->direction2 + last.ratio * last.direction1;
  return (sum - both.ratio * (between_from_before * both.direction1)).norm() / both.ratio;
}

std::optional<Rigid3> PoseByStep(const GroundStepFrom& step, const Rigid3& from, const Rigid3& to,
                                 double camera_height) {
  const Eigen::Vector3d direction = from.rotation * step.direction1;
  const Eigen::Vector3d up = to.rotation * step.up;
  const Eigen::Vector3d tracked_direction = to.rotation * step.direction2;
  const double turn =
      std::atan2(up.dot(tracked_direction.cross(direction)), tracked_direction.dot(direction));
  const double length = step.ratio * camera_height;
  const double factor = length / (to.translation - from.translation).norm();
  const bool is_turned =
      std::abs(turn) > kMaxSigmas * std::hypot(step.turn_sigma, kTrackedTurnSigma);
  const bool is_right =
      std::abs(std::log(factor)) <= kMaxSigmas * std::hypot(step.sigma, kTrackedSigma);
  if (is_right && !is_turned) return std::nullopt;
  Rigid3 pose{to.rotation, from.translation + length * direction};
  if (is_turned) pose.rotation = (ExpSo3(turn * up) * to.rotation).normalized();
  return pose;
}

void CorrectStep(KeyframeId id, const KnownGround& ground, Map* map) {
  Keyframe& keyframe = map->keyframe(id);
  if (keyframe.ground_steps.empty()) return;
  const GroundStepFrom& step = keyframe.ground_steps.front();
  const Rigid3& from = map->keyframe(step.keyframe).world_from_camera;
  const auto pose = PoseByStep(step, from, keyframe.world_from_camera, ground.camera_height);
  if (!pose) return;
  keyframe.world_from_camera = *pose;
  const std::vector<LandmarkId> landmarks = keyframe.landmarks;
  for (const LandmarkId landmark : landmarks) {
    if (landmark != kNoId) Retriangulate(landmark, map);
  }
}

}  // namespace orb360
