#include "slam/pipeline/patch_view.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/bearing.h"

namespace orb360 {
namespace {

// Samples to a pixel of the level on which the feature was found, in each direction: a patch of
// 5 x 5 of these pixels rarely reaches beyond the surface its corner is on.
constexpr double kSamplesPerPixel = 2.0;

// A patch seen from so much farther away is less than three pixels of the image wide.
constexpr double kMinStep = 0.25;  // pixels of level 0

// The level on which samples `spacing` rad apart are nearest to one pixel apart.
const PyramidLevel& LevelFor(const SpherePyramid& image, double spacing) {
  const double scale = spacing / image.front().camera.AngleOfPixels(1.0);
  const double level_ratio = RangeAtLevelZero(1.0, 1);
  const double level = std::round(std::log(scale) / std::log(level_ratio));
  return image[static_cast<size_t>(std::clamp(level, 0.0, static_cast<double>(image.size()) - 1))];
}

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
  view.level = &level;
  view.grid.steps = jacobian * steps;
  view.stretch = jacobian * by_slope;
  return view;
}

}  // namespace

std::shared_ptr<const LandmarkPatch> CutPatch(const Keyframe& keyframe, int feature) {
  const PyramidLevel& found_on = (*keyframe.image)[keyframe.features->keypoints[feature].level];
  const Eigen::Vector3d& bearing = keyframe.features->bearings[feature];
  const double spacing = found_on.camera.AngleOfPixels(1.0 / kSamplesPerPixel);
  const std::optional<PatchView> view =
      ViewOf(LevelFor(*keyframe.image, spacing), bearing, spacing * TangentBasis(bearing),
             Eigen::Vector3d::Zero(), spacing);
  if (!view) return nullptr;
  const std::optional<Patch> patch = SamplePatch(*view->level, view->grid);
  if (!patch) return nullptr;
  return std::make_shared<const LandmarkPatch>(
      LandmarkPatch{keyframe.id, bearing, spacing, *patch});
}

std::optional<PatchView> ViewPatch(const Map& map, const Landmark& landmark,
                                   const Keyframe& keyframe) {
  const LandmarkPatch& patch = *landmark.patch;
  const Rigid3 reference = map.PoseOf(patch.keyframe);
  const Rigid3 camera_from_world = keyframe.world_from_camera.Inverse();
  const Eigen::Vector3d position = camera_from_world * landmark.position;
  const double range = position.norm();
  const double footprint = patch.spacing * (landmark.position - reference.translation).norm();
  const double spacing = footprint / range;
  const double pixel = keyframe.image->front().camera.AngleOfPixels(1.0);
  if (!(range > 0 && spacing > kMinStep * pixel)) return std::nullopt;
  // With a plane's inverse range 1 + slope^T s, as a fraction, at sample s of the reference, its
  // point is at (footprint / spacing) (bearing + spacing basis s) / (1 + slope^T s) from there.
  // Times that denominator, which does not change its direction, and seen from here:
  //   position + (footprint rotation basis + center slope^T) s.
  const Eigen::Vector3d center = camera_from_world * reference.translation;
  const Eigen::Matrix3d rotation =
      (camera_from_world.rotation * reference.rotation).toRotationMatrix();
  return ViewOf(LevelFor(*keyframe.image, spacing), position,
                footprint * rotation * TangentBasis(patch.bearing) +
                    center * landmark.patch_slope.mean.transpose(),
                center, spacing);
}

}  // namespace orb360
