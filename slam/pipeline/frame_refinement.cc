#include "slam/pipeline/frame_refinement.h"

namespace orb360 {

std::vector<Sighting> SightingsOf(const TrackedFrame& frame) {
  std::vector<Sighting> sightings;
  for (size_t f = 0; f < frame.landmarks.size(); ++f) {
    if (frame.landmarks[f] == kNoId) continue;
    sightings.push_back({frame.landmarks[f], frame.features->bearings[f].cast<float>(),
                         frame.features->keypoints[f].sigma});
  }
  return sightings;
}

Rigid3 RefineFrame(const Map& map, const Rigid3& world_from_camera,
                   std::span<const Sighting> sightings, const std::optional<PositionPrior>& prior) {
  std::vector<PoseObservation> observations;
  for (const Sighting& sighting : sightings) {
    const LandmarkId id = map.Resolve(sighting.landmark);
    if (id == kNoId) continue;
    observations.push_back(
        {map.landmark(id).position, sighting.bearing.cast<double>(), sighting.sigma});
  }
  const RefinedPose refined = RefinePose(world_from_camera, observations, prior);
  // A few landmarks, or the smaller part of them, may agree on a wrong pose. The refined pose needs
  // as many inliers as tracking does (TrackerOptions::min_motion_inliers), and half of the
  // sightings, unless it lies where the keyframes around it let expect it: then the others were
  // observed in a wrong pose.
  constexpr int kEnough = 20;
  const bool is_expected =
      prior &&
      prior->ErrorOf(refined.world_from_camera.translation).squaredNorm() <= kPriorChiSquared95;
  const bool is_sure =
      refined.num_inliers >= kEnough &&
      (is_expected || 2 * refined.num_inliers >= static_cast<int>(sightings.size()));
  const Rigid3& pose = is_sure ? refined.world_from_camera : world_from_camera;
  // No camera leaves the path that far: most landmarks are far then, or move with the camera.
  constexpr double kMaxSigmas = 5.0;
  if (prior && prior->ErrorOf(pose.translation).norm() > kMaxSigmas) {
    return {pose.rotation, prior->position};
  }
  return pose;
}

}  // namespace orb360
