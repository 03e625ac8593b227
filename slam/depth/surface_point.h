#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// A point of a dense cloud.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  /// Unit, towards the cameras that saw it.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<std::uint8_t, 3> rgb{};
  /// In 0..1: 1 / confidence - 1 is the distance from the surface to be expected, in voxels.
  float confidence = 0.0f;
};

}  // namespace orb360
