#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace orb360 {

/// One camera of what is exported: the panorama itself, or a pinhole camera at the same place that
/// shows a part of it. All frames are the optical ones (x right, y down, z forward), and pixels are
/// continuous with the centre of the top-left one at (0.5, 0.5).
struct View {
  std::string name;  ///< Folder of its images; empty for the panorama.
  int width = 0;     ///< Pixels.
  int height = 0;    ///< Pixels.
  double focal = 0;  ///< Focal length of a pinhole camera, pixels; 0 for the panorama.
  Eigen::Quaterniond view_from_optical = Eigen::Quaterniond::Identity();

  bool is_panorama() const { return focal == 0; }
};

/// Returns the panorama as the only view.
std::vector<View> PanoramaView(int width, int height);

/// Returns the six faces of a cube (front, right, back, left, up, down), `fov` radians wide and
/// high. At its centre, a face has the resolution of a panorama of `panorama_width` pixels at the
/// horizon. The bottom of `up` and the top of `down` are the front.
std::vector<View> CubeViews(int panorama_width, double fov);

/// Returns `count` views around the camera's vertical axis, of the same size, from the front to the
/// right. Contract: 100 at most.
std::vector<View> RingViews(int panorama_width, int count, double fov);

/// Returns the pixel of a point in the optical frame, which may lie outside the image. None for a
/// point that is not in front of a pinhole camera.
std::optional<Eigen::Vector2d> ProjectToView(const View& view, const Eigen::Vector3d& point);

/// Returns whether a pixel lies in the image.
inline bool ContainsPixel(const View& view, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0 && pixel.x() < view.width && pixel.y() >= 0 && pixel.y() < view.height;
}

/// Returns the direction of a pixel in the optical frame, of length 1.
Eigen::Vector3d DirectionOfPixel(const View& view, const Eigen::Vector2d& pixel);

}  // namespace orb360
