#include "slam/io/octree/octree_normal.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

/// The middle of 1..255, and the steps from there to either end.
constexpr int kMiddle = 128;
constexpr float kSteps = 127;

float SignOf(float value) { return value < 0 ? -1.0f : 1.0f; }

/// Mirrors a point at the square that is the edge of the upper half.
Eigen::Vector2f Fold(const Eigen::Vector2f& p) {
  return {(1 - std::abs(p.y())) * SignOf(p.x()), (1 - std::abs(p.x())) * SignOf(p.y())};
}

}  // namespace

std::uint16_t OctahedralNormal(const Eigen::Vector3f& normal) {
  const float sum = normal.cwiseAbs().sum();
  if (!(sum > 0) || !std::isfinite(sum)) return 0;
  Eigen::Vector2f p = normal.head<2>() / sum;
  if (normal.z() < 0) p = Fold(p);
  const auto byte = [](float value) {
    return static_cast<std::uint16_t>(
        std::clamp(static_cast<int>(std::lround(value * kSteps)) + kMiddle, 1, 255));
  };
  return static_cast<std::uint16_t>(byte(p.x()) | byte(p.y()) << 8);
}

Eigen::Vector3f NormalFromOctahedral(std::uint16_t code) {
  if (code == 0) return Eigen::Vector3f::Zero();
  const Eigen::Vector2f p =
      (Eigen::Vector2f(static_cast<float>(code & 255), static_cast<float>(code >> 8)) -
       Eigen::Vector2f::Constant(kMiddle)) /
      kSteps;
  const float z = 1 - p.cwiseAbs().sum();
  const Eigen::Vector2f xy = z < 0 ? Fold(p) : p;
  return Eigen::Vector3f(xy.x(), xy.y(), z).normalized();
}

}  // namespace orb360
