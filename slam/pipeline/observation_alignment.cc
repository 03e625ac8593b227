#include "slam/pipeline/observation_alignment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "slam/features/patch_alignment.h"
#include "slam/geometry/bearing.h"

namespace orb360 {
namespace {

// Samples to a pixel of the level on which the feature was found, in each direction: a patch of
// 5 x 5 of these pixels rarely reaches beyond the surface its corner is on.
constexpr double kSamplesPerPixel = 2.0;
// Noise of aligned bearings as a share of a corner's on the same level; less makes trajectories no
// better (docs/features.md).
constexpr double kAlignedNoise = 0.35;
// The patch's own direction counts less than theirs: what is wrong with the patch moves all that
// are aligned with it in the same way, and they agree with each other.
constexpr double kPatchNoise = 0.5;

// Standard deviation of the slope of a surface that nothing is known of: the tangent of the angle
// between its normal and the view. And of the ground's normal, rad.
constexpr double kSlopeSigma = 2.0;
constexpr double kGroundSigma = 0.05;
// What lies this share of the camera's height above or below the ground may be the ground.
constexpr double kGroundTolerance = 0.15;
// How much farther away, as a share, the ground may be at a patch's rim.
constexpr double kMaxReach = 0.5;

// A patch seen from so much farther away is less than three pixels of the picture wide.
constexpr double kMinStep = 0.25;  // pixels of level 0

// The level on which samples `spacing` rad apart are nearest to one pixel apart.
const PyramidLevel& LevelFor(const SpherePyramid& picture, double spacing) {
  const double scale = spacing / picture.front().camera.AngleOfPixels(1.0);
  const double level_ratio = RangeAtLevelZero(1.0, 1);
  const double level = std::round(std::log(scale) / std::log(level_ratio));
  return picture[static_cast<size_t>(
      std::clamp(level, 0.0, static_cast<double>(picture.size()) - 1))];
}

// A grid that shows a patch, and how its steps change with the surface's slope (AlignPatch).
struct PatchView {
  PatchGrid grid;
  Eigen::Vector2d stretch;
};

// The patch around `point` whose samples are `steps` apart, seen by a camera at the origin, where
// steps change by `by_slope` times the slope; `spacing` is their angle. None so near a pole that
// lines are bent by half a sample at the patch's rim: by tan(latitude) / 2 times the square of
// their length.
std::optional<PatchView> ViewOf(const PyramidLevel& level, const Eigen::Vector3d& point,
                                const Eigen::Matrix<double, 3, 2>& steps,
                                const Eigen::Vector3d& by_slope, double spacing) {
  constexpr double kSquaredRadius = Patch::kRadius * Patch::kRadius;
  const double horizontal = point.head<2>().norm();
  if (kSquaredRadius * spacing * std::abs(point.z()) > horizontal) return std::nullopt;
  PatchView view;
  Eigen::Matrix<double, 2, 3> jacobian;
  if (!level.camera.Project(point, &view.grid.center, &jacobian)) return std::nullopt;
  view.grid.steps = jacobian * steps;
  view.stretch = jacobian * by_slope;
  return view;
}

std::shared_ptr<const LandmarkPatch> PatchOf(const Keyframe& keyframe, int feature) {
  const PyramidLevel& found_on = (*keyframe.picture)[keyframe.features->keypoints[feature].level];
  const Eigen::Vector3d& bearing = keyframe.features->bearings[feature];
  const double spacing = found_on.camera.AngleOfPixels(1.0 / kSamplesPerPixel);
  const PyramidLevel& level = LevelFor(*keyframe.picture, spacing);
  const std::optional<PatchView> view =
      ViewOf(level, bearing, spacing * TangentBasis(bearing), Eigen::Vector3d::Zero(), spacing);
  if (!view) return nullptr;
  const std::optional<Patch> patch = SamplePatch(level, view->grid);
  if (!patch) return nullptr;
  return std::make_shared<const LandmarkPatch>(
      LandmarkPatch{keyframe.id, bearing, spacing, *patch});
}

// Before any picture is compared with the patch, which is `keyframe`'s.
PatchSlope ExpectSlope(const Keyframe& keyframe, const LandmarkPatch& patch,
                       const Eigen::Vector3d& position, const std::optional<KnownGround>& ground) {
  const auto slope = [&](const Eigen::Vector2d& tangent, double sigma) {
    return PatchSlope{patch.spacing * tangent,
                      Eigen::Matrix2d::Identity() / std::pow(patch.spacing * sigma, 2)};
  };
  const PatchSlope unknown = slope(Eigen::Vector2d::Zero(), kSlopeSigma);
  if (!ground) return unknown;
  const Rigid3& pose = keyframe.world_from_camera;
  const double height = ground->up.dot(pose.translation - position);
  const Eigen::Vector3d normal = pose.rotation.conjugate() * ground->up;
  const double cosine = -normal.dot(patch.bearing);
  const bool is_ground = std::abs(height / ground->camera_height - 1) < kGroundTolerance;
  const Eigen::Vector2d tangent = TangentBasis(patch.bearing).transpose() * normal / -cosine;
  // Seen flatter, it would reach too far away within the patch.
  const bool is_even = cosine > 0 && Patch::kRadius * patch.spacing * tangent.norm() < kMaxReach;
  if (!(is_ground && is_even)) return unknown;
  return slope(tangent, kGroundSigma * (1 + tangent.squaredNorm()));  // derivative of the tangent
}

void Align(const Map& map, Landmark* landmark, Observation* observation) {
  observation->was_compared = true;
  const LandmarkPatch& patch = *landmark->patch;
  const Keyframe& keyframe = map.keyframe(observation->keyframe);
  const Rigid3 reference = map.PoseOf(patch.keyframe);
  const Rigid3 camera_from_world = keyframe.world_from_camera.Inverse();
  const Eigen::Vector3d position = camera_from_world * landmark->position;
  const double range = position.norm();
  const double footprint = patch.spacing * (landmark->position - reference.translation).norm();
  const double spacing = footprint / range;
  const double pixel = keyframe.picture->front().camera.AngleOfPixels(1.0);
  if (!(range > 0 && spacing > kMinStep * pixel)) return;
  const PyramidLevel& level = LevelFor(*keyframe.picture, spacing);
  // With a plane's inverse range 1 + slope^T s, as a share, at sample s of the reference, its point
  // is at (footprint / spacing) (bearing + spacing basis s) / (1 + slope^T s) from there. Times
  // that denominator, which does not change its direction, and seen from here:
  //   position + (footprint rotation basis + center slope^T) s.
  const Eigen::Vector3d center = camera_from_world * reference.translation;
  const Eigen::Matrix3d rotation =
      (camera_from_world.rotation * reference.rotation).toRotationMatrix();
  const PatchSlope& slope = landmark->patch_slope;
  std::optional<PatchView> guess =
      ViewOf(level, position,
             footprint * rotation * TangentBasis(patch.bearing) + center * slope.mean.transpose(),
             center, spacing);
  if (!guess) return;
  guess->grid.center = level.camera.Project(keyframe.features->bearings[observation->feature]);
  const std::optional<AlignedPatch> aligned =
      AlignPatch(patch.patch, level, guess->grid, guess->stretch, slope);
  if (!aligned) return;
  landmark->patch_slope = aligned->slope;
  const double corner_noise = keyframe.features->keypoints[observation->feature].sigma;
  observation->aligned_bearing = level.camera.Bearing(aligned->center).cast<float>();
  observation->aligned_sigma = static_cast<float>(kAlignedNoise * corner_noise);
}

// Bundle adjustment may have found since that the keyframe with the patch shows something else.
void DropWrongPatch(const Map& map, Landmark* landmark) {
  if (!landmark->patch || !map.HasKeyframe(landmark->patch->keyframe)) return;
  if (landmark->FindObservation(landmark->patch->keyframe) != nullptr) return;
  landmark->patch.reset();
  for (Observation& observation : landmark->observations) {
    observation.aligned_sigma = 0;
    observation.was_compared = false;
  }
}

// What was aligned with a patch that a stored map has not kept does not fit another one.
bool MayGetPatch(const Landmark& landmark) {
  return !landmark.patch && std::ranges::all_of(landmark.observations, [](const Observation& o) {
    return o.aligned_sigma == 0;
  });
}

}  // namespace

void AlignObservations(KeyframeId id, const std::optional<KnownGround>& ground, Map* map) {
  const Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.picture) return;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId) continue;
    Landmark& landmark = map->landmark(keyframe.landmarks[f]);
    DropWrongPatch(*map, &landmark);
    if (MayGetPatch(landmark)) {
      landmark.patch = PatchOf(keyframe, static_cast<int>(f));
      if (!landmark.patch) continue;
      landmark.patch_slope = ExpectSlope(keyframe, *landmark.patch, landmark.position, ground);
      Observation& own = *landmark.FindObservation(id);
      own.aligned_bearing = landmark.patch->bearing.cast<float>();
      own.aligned_sigma = static_cast<float>(kPatchNoise * keyframe.features->keypoints[f].sigma);
      own.was_compared = true;
    }
    if (!landmark.patch) continue;
    for (Observation& observation : landmark.observations) {
      if (observation.was_compared || !map->keyframe(observation.keyframe).picture) continue;
      Align(*map, &landmark, &observation);
    }
  }
}

}  // namespace orb360
