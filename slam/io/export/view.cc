#include "slam/io/export/view.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "slam/io/optical_frame.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {
namespace {

/// The view whose z axis is `forward` and whose x axis is `right`; unit vectors, optical frame.
View PinholeView(std::string name, int panorama_width, double fov, const Eigen::Vector3d& right,
                 const Eigen::Vector3d& forward) {
  View view;
  view.name = std::move(name);
  view.focal = panorama_width / (2.0 * std::numbers::pi);
  // An even number of pixels is what encoders of videos want.
  view.width = 2 * static_cast<int>(std::lround(view.focal * std::tan(0.5 * fov)));
  view.height = view.width;
  Eigen::Matrix3d optical_from_view;
  optical_from_view << right, forward.cross(right), forward;
  view.view_from_optical = Eigen::Quaterniond(optical_from_view).conjugate();
  return view;
}

/// The view to the horizon, `yaw` radians to the right of the front.
View SideView(std::string name, int panorama_width, double fov, double yaw) {
  const double cosine = std::cos(yaw);
  const double sine = std::sin(yaw);
  return PinholeView(std::move(name), panorama_width, fov, {cosine, 0, -sine}, {sine, 0, cosine});
}

}  // namespace

std::vector<View> PanoramaView(int width, int height) {
  return {View{"", width, height, 0, Eigen::Quaterniond::Identity()}};
}

std::vector<View> CubeViews(int panorama_width, double fov) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  std::vector<View> views;
  int quarter = 0;
  for (const char* name : {"front", "right", "back", "left"}) {
    views.push_back(SideView(name, panorama_width, fov, kQuarter * quarter++));
  }
  const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  views.push_back(PinholeView("up", panorama_width, fov, right, -Eigen::Vector3d::UnitY()));
  views.push_back(PinholeView("down", panorama_width, fov, right, Eigen::Vector3d::UnitY()));
  return views;
}

std::vector<View> RingViews(int panorama_width, int count, double fov) {
  ORB360_CHECK(count > 0 && count <= 100, count);
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "view_%02d", i);
    views.push_back(SideView(name, panorama_width, fov, 2.0 * std::numbers::pi * i / count));
  }
  return views;
}

std::optional<Eigen::Vector2d> ProjectToView(const View& view, const Eigen::Vector3d& point) {
  if (view.is_panorama()) {
    return EquirectangularCamera(view.width, view.height).Project(CameraFromOptical() * point);
  }
  const Eigen::Vector3d p = view.view_from_optical * point;
  if (!(p.z() > 0)) return std::nullopt;
  return Eigen::Vector2d(view.focal * p.x() / p.z() + 0.5 * view.width,
                         view.focal * p.y() / p.z() + 0.5 * view.height);
}

Eigen::Vector3d DirectionOfPixel(const View& view, const Eigen::Vector2d& pixel) {
  if (view.is_panorama()) {
    return CameraFromOptical().conjugate() *
           EquirectangularCamera(view.width, view.height).Bearing(pixel);
  }
  return view.view_from_optical.conjugate() *
         Eigen::Vector3d(pixel.x() - 0.5 * view.width, pixel.y() - 0.5 * view.height, view.focal)
             .normalized();
}

}  // namespace orb360
