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

// The level on which samples `spacing` rad apart are nearest to one pixel apart.
const PyramidLevel& LevelFor(const SpherePyramid& picture, double spacing) {
  const double scale = spacing / picture.front().camera.AngleOfPixels(1.0);
  const double level = std::round(std::log(scale) / std::log(RangeAtLevelZero(1.0, 1)));
  return picture[static_cast<size_t>(
      std::clamp(level, 0.0, static_cast<double>(picture.size()) - 1))];
}

// The grid around the direction of `point`, whose steps are `steps` in the camera frame. None on
// the polar axis.
std::optional<PatchGrid> GridAt(const PyramidLevel& level, const Eigen::Vector3d& point,
                                const Eigen::Matrix<double, 3, 2>& steps) {
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
  const std::optional<PatchGrid> grid = GridAt(level, bearing, spacing * TangentBasis(bearing));
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
  if (!(range > 0)) return;
  const double footprint = patch.spacing * reference_range;
  const double spacing = footprint / range;
  const PyramidLevel& level = LevelFor(*keyframe.picture, spacing);
  std::optional<PatchGrid> guess =
      GridAt(level, position,
             camera_from_reference.toRotationMatrix() * footprint * TangentBasis(patch.bearing));
  if (!guess) return;
  guess->center = level.camera.Project(keyframe.features->bearings[observation->feature]);
  const std::optional<Eigen::Vector2d> center = AlignPatch(patch.patch, level, *guess);
  if (!center) return;
  const double corner_noise = keyframe.features->keypoints[observation->feature].sigma;
  observation->aligned_bearing = level.camera.Bearing(*center).cast<float>();
  observation->aligned_sigma = static_cast<float>(kAlignedNoise * corner_noise);
}

}  // namespace

void AlignObservations(KeyframeId id, Map* map) {
  const Keyframe& keyframe = map->keyframe(id);
  if (!keyframe.picture) return;
  for (size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    if (keyframe.landmarks[f] == kNoId) continue;
    Landmark& landmark = map->landmark(keyframe.landmarks[f]);
    const bool is_new = !landmark.patch;
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
