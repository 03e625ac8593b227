#include "slam/pipeline/patch_view.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/bearing.h"

namespace orb360 {
namespace {

// Number of samples for each pixel of the level on which the feature was found, in each direction.
// The patch then covers 5 x 5 pixels and rarely extends beyond the surface of its corner.
constexpr double kSamplesPerPixel = 2.0;

// Least distance between samples, pixels of level 0. A patch that is seen from so far away that the
// distance is smaller covers less than three pixels of the image.
constexpr double kMinStep = 0.25;

// Returns the level on which a distance of `spacing` rad between samples is nearest to one pixel.
const PyramidLevel& LevelFor(const SpherePyramid& image, double spacing) {
  const double scale = spacing / image.front().camera.AngleOfPixels(1.0);
  const double level_ratio = RangeAtLevelZero(1.0, 1);
  const double level = std::round(std::log(scale) / std::log(level_ratio));
  return image[static_cast<size_t>(std::clamp(level, 0.0, static_cast<double>(image.size()) - 1))];
}

// Returns the view of the patch around `point`, whose samples are `steps` apart, by a camera at the
// origin. The steps change by `by_slope` times the slope, and `spacing` is their angle, rad. Empty
// so near a pole that lines in the image deviate by half a sample at the patch's rim: their
// deviation is tan(latitude) / 2 times the square of their length.
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
  // Let 1 + slope^T s be the inverse range of a plane at sample s of the reference, relative to
  // that at its centre. The point of the plane is then, in the reference camera's frame, (footprint
  // / spacing) (bearing + spacing basis s) / (1 + slope^T s). Multiplication by the denominator
  // does not change the direction in which this camera sees the point, which is that of
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
