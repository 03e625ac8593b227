#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace orb360 {

/// A fisheye lens: equidistant, with a polynomial of the angle from its axis.
///
/// Lens frame: x to the right, y downwards, z along the axis. A ray at the angle t from the axis is
/// seen at the distance r(t) = focal * (t + k1 t^3 + k2 t^5 + k3 t^7 + k4 t^9) from the centre, t
/// in radians (Kannala and Brandt, 2006; the fisheye model of OpenCV).
struct FisheyeLens {
  /// Size of the image, pixels.
  cv::Size size;
  /// Pixel of the axis; the centre of the top-left pixel is (0.5, 0.5).
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  /// Pixels per radian at the axis.
  double focal = 0.0;
  /// k1 to k4.
  std::array<double, 4> polynomial{};
  /// Full angle of what the lens shows, radians.
  double field_of_view = 0.0;
  /// Rotation of the lens: a direction in the optical frame of the camera (x right, y down, z
  /// forward) from that in the lens frame.
  Eigen::Quaterniond camera_from_lens = Eigen::Quaterniond::Identity();
  /// Centre of the lens in the optical frame of the camera, metres.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();

  /// Returns r for an angle from the axis, pixels.
  double Radius(double angle) const;
};

/// Returns the pixel of a ray in the lens frame, of any length above 0, whether the lens shows it
/// or not.
Eigen::Vector2d Project(const FisheyeLens& lens, const Eigen::Vector3d& ray);

/// Returns the same lens for images that are scaled to `size`. Both axes must have the same scale
/// to 1 %; otherwise nullopt.
std::optional<FisheyeLens> ScaledTo(const FisheyeLens& lens, cv::Size size);

/// Whether r grows with the angle up to the rim of the image, as it must.
bool IsMonotonic(const FisheyeLens& lens);

}  // namespace orb360
