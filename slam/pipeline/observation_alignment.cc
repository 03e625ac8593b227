#include "slam/pipeline/observation_alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "slam/geometry/bearing.h"
#include "slam/pipeline/patch_view.h"

namespace orb360 {
namespace {

// Noise of the patch's own bearing relative to that of an aligned one. An error of the patch moves
// all observations that are aligned with it in the same way, so they remain consistent with each
// other.
constexpr double kPatchNoise = 0.5;

// Standard deviation of the slope of an unknown surface, which is the tangent of the angle between
// its normal and the viewing direction; and standard deviation of the ground's normal, rad.
constexpr double kSlopeSigma = 2.0;
constexpr double kGroundSigma = 0.05;
// A landmark may be on the ground if its height above or below it is less than this fraction of the
// camera's height.
constexpr double kGroundTolerance = 0.15;
// Largest relative difference between the ranges of the ground at a patch's rim and at its centre.
constexpr double kMaxReach = 0.5;

// Returns the slope of a patch of `keyframe` before any other image is aligned with it.
PatchSlope ExpectSlope(const Keyframe& keyframe, const LandmarkPatch& patch,
                       const Eigen::Vector3d& position, const std::optional<KnownGround>& ground) {
  const auto slope = [&](const Eigen::Vector2d& tangent, double sigma) {
    return PatchSlope{patch.spacing * tangent,
                      Eigen::Matrix2d::Identity() / std::pow(patch.spacing * sigma, 2)};
  };
  PatchSlope unknown = slope(Eigen::Vector2d::Zero(), kSlopeSigma);
  if (!ground) return unknown;
  const Rigid3& pose = keyframe.world_from_camera;
  const double height = ground->up.dot(pose.translation - position);
  const Eigen::Vector3d normal = pose.rotation.conjugate() * ground->up;
  const double cosine = -normal.dot(patch.bearing);
  const bool is_ground = std::abs(height / ground->camera_height - 1) < kGroundTolerance;
  const Eigen::Vector2d tangent = TangentBasis(patch.bearing).transpose() * normal / -cosine;
  // At a flatter angle the ranges within the patch would differ too much.
  const bool is_even = cosine > 0 && Patch::kRadius * patch.spacing * tangent.norm() < kMaxReach;
  if (!(is_ground && is_even)) return unknown;
  // The derivative of the tangent turns the error of the angle into one of the slope.
  return slope(tangent, kGroundSigma * (1 + tangent.squaredNorm()));
}

void Align(const Map& map, Landmark* landmark, Observation* observation) {
  observation->was_compared = true;
  const Keyframe& keyframe = map.keyframe(observation->keyframe);
  std::optional<PatchView> guess = ViewPatch(map, *landmark, keyframe);
  if (!guess) return;
  const EquirectangularCamera& camera = guess->level->camera;
  guess->grid.center = camera.Project(keyframe.features->bearings[observation->feature]);
  const std::optional<AlignedPatch> aligned = AlignPatch(
      landmark->patch->patch, *guess->level, guess->grid, guess->stretch, landmark->patch_slope);
  if (!aligned) return;
  landmark->patch_slope = aligned->slope;
  const double corner_noise = keyframe.features->keypoints[observation->feature].sigma;
  observation->aligned_bearing = camera.Bearing(aligned->center).cast<float>();
  observation->aligned_sigma = static_cast<float>(kAlignedNoise * corner_noise);
}

// Drops the patch of a landmark whose keyframe no longer observes the landmark, because bundle
// adjustment has rejected the observation.
void DropWrongPatch(const Map& map, Landmark* landmark) {
  if (!landmark->patch || !map.HasKeyframe(landmark->patch->keyframe)) return;
  if (landmark->FindObservation(landmark->patch->keyframe) != nullptr) return;
  landmark->patch.reset();
  for (Observation& observation : landmark->observations) {
    observation.aligned_sigma = 0;
    observation.was_compared = false;
  }
}

// Observations that were aligned with a patch that a stored map does not contain would not be
// consistent with another patch.
bool MayGetPatch(const Landmark& landmark) {
  return !landmark.patch && std::ranges::all_of(landmark.observations, [](const Observation& o) {
    return o.aligned_sigma == 0;
  });
}

}  // namespace

void AlignObservations(KeyframeId id, const std::optional<KnownGround>& ground, Map* map) {
  const Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.image) return;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId) continue;
    Landmark& landmark = map->landmark(keyframe.landmarks[f]);
    DropWrongPatch(*map, &landmark);
    if (MayGetPatch(landmark)) {
      landmark.patch = CutPatch(keyframe, static_cast<int>(f));
      if (!landmark.patch) continue;
      landmark.patch_slope = ExpectSlope(keyframe, *landmark.patch, landmark.position, ground);
      Observation& own = *landmark.FindObservation(id);
      own.aligned_bearing = landmark.patch->bearing.cast<float>();
      own.aligned_sigma = static_cast<float>(kPatchNoise * keyframe.features->keypoints[f].sigma);
      own.was_compared = true;
    }
    if (!landmark.patch) continue;
    for (Observation& observation : landmark.observations) {
      if (observation.was_compared || !map->keyframe(observation.keyframe).image) continue;
      Align(*map, &landmark, &observation);
    }
  }
}

}  // namespace orb360
