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
// Noise of aligned bearings as a share of a corner's on the same level, measured
// (docs/features.md).
constexpr double kAlignedNoise = 0.35;
// The patch's own direction counts less than theirs: where its surface does not face the camera,
// all that are aligned with it are off in the same way, and agree with each other.
constexpr double kPatchNoise = 0.5;

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

// The grid around the direction of `point`, whose steps are `steps` in the camera frame, about
// `spacing` rad. None so near a pole that lines are bent by half a sample at the patch's rim: by
// tan(latitude) / 2 times the square of their length.
std::optional<PatchGrid> GridAt(const PyramidLevel& level, const Eigen::Vector3d& point,
                                const Eigen::Matrix<double, 3, 2>& steps, double spacing) {
  constexpr double kSquaredRadius = Patch::kRadius * Patch::kRadius;
  const double horizontal = point.head<2>().norm();
  if (kSquaredRadius * spacing * std::abs(point.z()) > horizontal) return std::nullopt;
  PatchGrid grid;
  Eigen::Matrix<double, 2, 3> jacobian;
  if (!level.camera.Project(point, &grid.center, &jacobian)) return std::nullopt;
  grid.steps = jacobian * steps;
  return grid;
}

std::shared_ptr<const LandmarkPatch> PatchOf(const Keyframe& keyframe, int feature) {
  const PyramidLevel& found_on = (*keyframe.picture)[keyframe.features->keypoints[feature].level];
  const Eigen::Vector3d& bearing = keyframe.features->bearings[feature];
  const double spacing = found_on.camera.AngleOfPixels(1.0 / kSamplesPerPixel);
  const PyramidLevel& level = LevelFor(*keyframe.picture, spacing);
  const std::optional<PatchGrid> grid =
      GridAt(level, bearing, spacing * TangentBasis(bearing), spacing);
  if (!grid) return nullptr;
  const std::optional<Patch> patch = SamplePatch(level, *grid);
  if (!patch) return nullptr;
  return std::make_shared<const LandmarkPatch>(
      LandmarkPatch{keyframe.id, bearing, spacing, *patch});
}

void Align(const Map& map, const Landmark& landmark, Observation* observation) {
  const LandmarkPatch& patch = *landmark.patch;
  const Keyframe& keyframe = map.keyframe(observation->keyframe);
  const Rigid3 reference = map.PoseOf(patch.keyframe);
  const double reference_range = (landmark.position - reference.translation).norm();
  const Eigen::Vector3d position = keyframe.world_from_camera.Inverse() * landmark.position;
  const double range = position.norm();
  const Eigen::Quaterniond camera_from_reference =
      keyframe.world_from_camera.rotation.conjugate() * reference.rotation;
  const double footprint = patch.spacing * reference_range;
  const double spacing = footprint / range;
  const double pixel = keyframe.picture->front().camera.AngleOfPixels(1.0);
  if (!(range > 0 && spacing > kMinStep * pixel)) return;
  const PyramidLevel& level = LevelFor(*keyframe.picture, spacing);
  std::optional<PatchGrid> guess = GridAt(
      level, position,
      camera_from_reference.toRotationMatrix() * footprint * TangentBasis(patch.bearing), spacing);
  if (!guess) return;
  guess->center = level.camera.Project(keyframe.features->bearings[observation->feature]);
  const std::optional<Eigen::Vector2d> center = AlignPatch(patch.patch, level, *guess);
  if (!center) return;
  const double corner_noise = keyframe.features->keypoints[observation->feature].sigma;
  observation->aligned_bearing = level.camera.Bearing(*center).cast<float>();
  observation->aligned_sigma = static_cast<float>(kAlignedNoise * corner_noise);
}

// Bundle adjustment may have found since that the keyframe with the patch shows something else.
void DropWrongPatch(const Map& map, Landmark* landmark) {
  if (!landmark->patch || !map.HasKeyframe(landmark->patch->keyframe)) return;
  if (landmark->FindObservation(landmark->patch->keyframe) != nullptr) return;
  landmark->patch.reset();
  for (Observation& observation : landmark->observations) observation.aligned_sigma = 0;
}

// What was aligned with a patch that a stored map has not kept does not fit another one.
bool MayGetPatch(const Landmark& landmark) {
  return !landmark.patch && std::ranges::all_of(landmark.observations, [](const Observation& o) {
    return o.aligned_sigma == 0;
  });
}

}  // namespace

void AlignObservations(KeyframeId id, Map* map) {
  const Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.picture) return;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId) continue;
    Landmark& landmark = map->landmark(keyframe.landmarks[f]);
    DropWrongPatch(*map, &landmark);
    const bool is_new = MayGetPatch(landmark);
    if (is_new) landmark.patch = PatchOf(keyframe, static_cast<int>(f));
    if (!landmark.patch) continue;
    for (Observation& observation : landmark.observations) {
      const bool is_own = observation.keyframe == id;
      if (is_own && is_new) {  // where the patch is, by definition
        observation.aligned_bearing = landmark.patch->bearing.cast<float>();
        observation.aligned_sigma =
            static_cast<float>(kPatchNoise * keyframe.features->keypoints[f].sigma);
      } else if ((is_own || is_new) && map->keyframe(observation.keyframe).picture) {
        Align(*map, landmark, &observation);
      }
    }
  }
}

}  // namespace orb360
