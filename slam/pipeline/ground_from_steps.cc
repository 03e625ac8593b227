#include "slam/pipeline/ground_from_steps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/pipeline/ground.h"
#include "slam/pipeline/ground_steps.h"

namespace orb360 {
namespace {

// Least fraction of the keyframes that must agree on the height of the camera.
constexpr double kMinAgreement = 0.8;
// Largest |ln| of the ratio of two heights that are the same.
constexpr double kMaxHeightError = 0.15;
// Number of keyframes to which the steps add up that tells that they are right, and the largest
// error of such a sum, as a fraction of it: rotations were tracked, and one that is wrong by 3
// degrees turns a sum by this.
constexpr int kMinClosed = 2;
constexpr double kMaxMisclosure = 0.06;

// Whether the step to a keyframe from the one but last before it is the sum of the steps between.
// These are three measurements of other pairs of images.
bool StepsAddUp(const Map& map, KeyframeId id) {
  const std::vector<GroundStepFrom>& steps = map.keyframe(id).ground_steps;
  if (steps.size() < 2) return false;
  const GroundStepFrom& last = steps[0];
  const GroundStepFrom& both = steps[1];
  if (!map.HasKeyframe(last.keyframe) || !map.HasKeyframe(both.keyframe)) return false;
  for (const GroundStepFrom& first : map.keyframe(last.keyframe).ground_steps) {
    if (first.keyframe != both.keyframe) continue;
    // In the frame of the keyframe in between.
    const Eigen::Quaterniond between_from_before =
        map.PoseOf(last.keyframe).rotation.conjugate() * map.PoseOf(both.keyframe).rotation;
    const Eigen::Vector3d sum = first.ratio * first.direction2 + last.ratio * last.direction1;
    const Eigen::Vector3d error = sum - both.ratio * (between_from_before * both.direction1);
    return error.norm() < kMaxMisclosure * both.ratio;
  }
  return false;
}

// The ground as the newest step to each of the keyframes shows it.
std::vector<GroundSighting> SightingsOf(const Map& map, std::span<const KeyframeId> keyframes) {
  std::vector<GroundSighting> sightings;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.keyframe(id);
    if (keyframe.ground_steps.empty()) continue;
    const GroundStepFrom& step = keyframe.ground_steps.front();
    const Rigid3& pose = keyframe.world_from_camera;
    const double length = (pose.translation - map.PoseOf(step.keyframe).translation).norm();
    sightings.push_back({pose.rotation * step.up, length / step.ratio});
  }
  return sightings;
}

}  // namespace

std::optional<KnownGround> GroundFromSteps(const Map& map, std::span<const KeyframeId> keyframes) {
  const std::vector<GroundSighting> sightings = SightingsOf(map, keyframes);
  if (const auto ground =
          AgreeOnGround(sightings, kMinAgreement * static_cast<double>(keyframes.size()))) {
    return ground;
  }
  // Where all landmarks are far, the tracked unit of length changes at each keyframe, so that the
  // heights disagree. The steps themselves tell then whether they are right. Later, the keyframes
  // could not be aligned to them any more (AlignFirstKeyframes).
  const auto adds_up = [&](KeyframeId id) { return StepsAddUp(map, id); };
  if (map.keyframe_end() > kGroundSearch || !adds_up(keyframes.back()) ||
      std::ranges::count_if(keyframes, adds_up) < kMinClosed) {
    return std::nullopt;
  }
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const GroundSighting& sighting : sightings) up += sighting.up;
  return KnownGround{up.normalized(), sightings.back().height};
}

bool AgreesWithSteps(const KnownGround& ground, const Map& map,
                     std::span<const KeyframeId> keyframes) {
  return std::ranges::all_of(SightingsOf(map, keyframes), [&](const GroundSighting& sighting) {
    return std::abs(std::log(sighting.height / ground.camera_height)) < kMaxHeightError;
  });
}

std::optional<Eigen::Vector3d> GroundNormalFromSteps(const Keyframe& keyframe) {
  if (keyframe.ground_steps.empty()) return std::nullopt;
  return keyframe.world_from_camera.rotation * keyframe.ground_steps.front().up;
}

}  // namespace orb360
