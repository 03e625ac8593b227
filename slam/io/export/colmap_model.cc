#include "slam/io/export/colmap_model.h"

#include <cmath>
#include <utility>

namespace orb360 {
namespace {

Rigid3 ViewFromWorld(const PosedFrame& frame, const View& view) {
  return Rigid3{view.view_from_optical, Eigen::Vector3d::Zero()} *
         frame.world_from_optical.Inverse();
}

/// Returns the distance of two pixels. In a panorama, u is periodic.
double PixelDistance(const View& view, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Eigen::Vector2d difference = a - b;
  if (view.is_panorama()) {
    difference.x() -= view.width * std::floor(difference.x() / view.width + 0.5);
  }
  return difference.norm();
}

/// Adds the observations of a frame that one of its images shows, and to the points their errors.
void AddObservations(const ExportScene& scene, const PosedFrame& frame, const View& view,
                     ColmapImage* image, std::vector<ColmapPoint>* points) {
  // In one view, the panorama, pixels stay what they are.
  const View panorama = PanoramaView(scene.model.width, scene.model.height).front();
  const Rigid3 optical_from_world = frame.world_from_optical.Inverse();
  for (const PointObservation& seen : frame.observations) {
    const auto index = static_cast<size_t>(seen.point);
    std::optional<Eigen::Vector2d> pixel = seen.pixel.cast<double>();
    if (!view.is_panorama()) pixel = ProjectToView(view, DirectionOfPixel(panorama, *pixel));
    if (!pixel || !(view.is_panorama() || ContainsPixel(view, *pixel))) continue;
    if (points->empty()) {  // A dense cloud takes the place of the landmarks.
      image->points.push_back({*pixel, kNoColmapPoint});
      continue;
    }
    ColmapPoint& point = (*points)[index];
    const auto projected = ProjectToView(view, optical_from_world * point.position);
    if (!projected) continue;
    point.error += PixelDistance(view, *projected, *pixel);
    point.track.push_back({image->id, static_cast<uint32_t>(image->points.size())});
    image->points.push_back({*pixel, index + 1});
  }
}

}  // namespace

ColmapModel MakeColmapModel(const ExportScene& scene) {
  ColmapModel model;
  std::vector<ColmapPoint> landmarks;
  if (!scene.cloud) {
    landmarks.reserve(scene.model.points.size());
    for (const ColoredLandmark& point : scene.model.points) {
      landmarks.push_back({landmarks.size() + 1, point.position, point.color, 0.0, {}});
    }
  }
  uint32_t frame_id = 0;
  for (const PosedFrame& frame : scene.model.frames) {
    ++frame_id;
    uint32_t camera_id = 0;
    for (const View& view : scene.views) {
      ColmapImage image;
      image.id = static_cast<uint32_t>(model.images.size() + 1);
      image.camera_id = ++camera_id;
      image.frame_id = frame_id;
      image.camera_from_world = ViewFromWorld(frame, view);
      image.name = ImageName(scene, frame, view);
      AddObservations(scene, frame, view, &image, &landmarks);
      model.images.push_back(std::move(image));
    }
  }
  for (ColmapPoint& point : landmarks) {
    if (point.track.empty()) continue;
    point.error /= static_cast<double>(point.track.size());
    model.points.push_back(std::move(point));
  }
  if (scene.cloud) {
    for (const ColoredLandmark& point : *scene.cloud) {
      model.points.push_back({model.points.size() + 1, point.position, point.color, -1.0, {}});
    }
  }
  return model;
}

Rigid3 ViewFromRig(const ExportScene& scene, const View& view) {
  return {(view.view_from_optical * scene.views.front().view_from_optical.conjugate()).normalized(),
          Eigen::Vector3d::Zero()};
}

Rigid3 RigFromWorld(const ExportScene& scene, const PosedFrame& frame) {
  return ViewFromWorld(frame, scene.views.front());
}

ColmapCameraModel CameraModelOf(const View& view) {
  const double width = view.width;
  const double height = view.height;
  if (view.is_panorama()) return {17, "EQUIRECTANGULAR", {width, height}};
  return {1, "PINHOLE", {view.focal, view.focal, 0.5 * width, 0.5 * height}};
}

}  // namespace orb360
