#pragma once

#include <numbers>

#include <Eigen/Core>

namespace orb360 {

/// The equirectangular camera (paper Eq. 1-4): an image of `width` x `height` pixels that covers
/// the whole sphere. Each axis has its own scale, so an image that is not exactly 2:1 is a
/// stretched full sphere.
///
/// Camera frame: -X forward, +Y right, +Z up. The longitude atan2(Y, -X) increases to the right
/// from the forward direction, the latitude asin(Z/r) upward. Pixels are continuous with the centre
/// of the top-left pixel at (0.5, 0.5); u is periodic with the image's width.
class EquirectangularCamera {
 public:
  /// Throws ContractError unless both sizes are positive.
  EquirectangularCamera(int width, int height);

  /// Returns the image's width, pixels.
  int width() const { return width_; }
  /// Returns the image's height, pixels.
  int height() const { return height_; }
  /// Returns f_x = W / 2 pi, pixels per radian of longitude (paper Eq. 1-4).
  double fx() const { return width_ / (2.0 * std::numbers::pi); }
  /// Returns f_y = -H / pi, pixels per radian of latitude; negative since v increases downward.
  double fy() const { return -height_ / std::numbers::pi; }
  /// Returns c_x = W / 2, the column of the forward direction, pixels.
  double cx() const { return 0.5 * width_; }
  /// Returns c_y = H / 2, the row of the horizon, pixels.
  double cy() const { return 0.5 * height_; }

  /// Returns the pixel of a point in the camera frame of any non-zero length (Eq. 1-2), with u in
  /// [0, width) and v in [0, height].
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;

  /// Projects a point as above, with the Jacobian d(u,v)/d(point). Returns false and leaves the
  /// outputs unchanged where the derivative does not exist: at the camera's centre and on the polar
  /// axis (within 1e-9 rad).
  bool Project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel,
               Eigen::Matrix<double, 2, 3>* jacobian) const;

  /// Returns the unit vector through a pixel (Eq. 3-4 with d = 1). u may lie outside [0, width).
  Eigen::Vector3d Bearing(const Eigen::Vector2d& pixel) const;

  /// Returns the point at `range` along the pixel's ray (Eq. 3-4). The range is the distance, not a
  /// depth along z.
  Eigen::Vector3d BackProject(const Eigen::Vector2d& pixel, double range) const {
    return range * Bearing(pixel);
  }

  /// Returns u modulo the width, in [0, width).
  double WrapU(double u) const;
  /// Returns a difference of two u modulo the width, in [-width/2, width/2).
  double WrapDeltaU(double du) const;

  /// Returns the angle in radians that `pixels` span at the image's equator: t * 2 pi / width.
  double AngleOfPixels(double pixels) const { return pixels * 2.0 * std::numbers::pi / width_; }

 private:
  int width_;
  int height_;
};

}  // namespace orb360
