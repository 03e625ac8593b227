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
  const auto adds_up = [&](KeyframeId id) {
    const std::optional<double> misclosure = MisclosureOfSteps(map, id);
    return misclosure && *misclosure < kMaxMisclosure;
  };
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
