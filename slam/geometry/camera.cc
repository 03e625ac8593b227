#include <algorithm>
#include <cmath>

#include <orb360/nn/base/check.h>
#include <orb360/slam/geometry/camera.h>

namespace orb360 {

EquirectangularCamera::EquirectangularCamera(int width, int height)
    : width_(width), height_(height) {
  ORB360_CHECK(width > 0 && height > 0, width, height);
}

Eigen::Vector2d EquirectangularCamera::Project(const Eigen::Vector3d& point) const {
  const double longitude = std::atan2(point.y(), -point.x());
  const double latitude = std::atan2(point.z(), std::hypot(point.x(), point.y()));
  return {WrapU(fx() * longitude + cx()), fy() * latitude + cy()};
}

bool EquirectangularCamera::Project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel,
                                    Eigen::Matrix<double, 2, 3>* jacobian) const {
  const double horizontal_squared = point.head<2>().squaredNorm();
  const double range_squared = point.squaredNorm();
  // The comparison is written as !(a > b) so that NaN is refused too.
  if (!(horizontal_squared > 1e-18 * range_squared)) return false;
  const double horizontal = std::sqrt(horizontal_squared);
  *pixel = Project(point);
  // d lon / d(X, Y) = (Y, -X) / (X^2 + Y^2); d lat / dP = (-X Z, -Y Z, X^2 + Y^2) / (h r^2).
  const double latitude_scale = 1.0 / (horizontal * range_squared);
  *jacobian << fx() * point.y() / horizontal_squared, -fx() * point.x() / horizontal_squared, 0.0,
      -fy() * point.x() * point.z() * latitude_scale,
      -fy() * point.y() * point.z() * latitude_scale, fy() * horizontal_squared * latitude_scale;
  return true;
}

Eigen::Vector3d EquirectangularCamera::Bearing(const Eigen::Vector2d& pixel) const {
  const double longitude = (pixel.x() - cx()) / fx();
  const double latitude = (pixel.y() - cy()) / fy();
  return {-std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}

double EquirectangularCamera::WrapU(double u) const {
  const double wrapped = u - width_ * std::floor(u / width_);
  return wrapped < width_ ? wrapped : 0.0;  // a tiny negative u rounds up to width
}

double EquirectangularCamera::WrapDeltaU(double du) const {
  return du - width_ * std::floor(du / width_ + 0.5);
}

}  // namespace orb360
