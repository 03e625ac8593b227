#include "slam/io/lenses/fisheye_lens.h"

#include <cmath>

namespace orb360 {

double FisheyeLens::Radius(double angle) const {
  const double square = angle * angle;
  double factor = 0.0;
  for (int i = 3; i >= 0; --i) factor = (factor + polynomial[i]) * square;
  return focal * angle * (1.0 + factor);
}

Eigen::Vector2d Project(const FisheyeLens& lens, const Eigen::Vector3d& ray) {
  const double side = std::hypot(ray.x(), ray.y());
  if (side == 0.0) return lens.center;
  const double radius = lens.Radius(std::atan2(side, ray.z()));
  return lens.center + radius / side * ray.head<2>();
}

std::optional<FisheyeLens> ScaledTo(const FisheyeLens& lens, cv::Size size) {
  constexpr double kMaxDifference = 0.01;
  const double x = 1.0 * size.width / lens.size.width;
  const double y = 1.0 * size.height / lens.size.height;
  if (!(std::abs(x / y - 1.0) <= kMaxDifference)) return std::nullopt;
  FisheyeLens scaled = lens;
  scaled.size = size;
  scaled.center = {lens.center.x() * x, lens.center.y() * y};
  scaled.focal = lens.focal * std::sqrt(x * y);
  return scaled;
}

bool IsMonotonic(const FisheyeLens& lens) {
  constexpr int kSteps = 200;
  double last = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double radius = lens.Radius(0.5 * lens.field_of_view * i / kSteps);
    if (!(radius > last)) return false;
    last = radius;
  }
  return true;
}

}  // namespace orb360
