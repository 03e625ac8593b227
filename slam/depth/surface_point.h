#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// A point of a dense cloud.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  /// Unit vector towards the cameras that saw the point.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<std::uint8_t, 3> rgb{};
  /// In 0..1: 1 / confidence - 1 is the expected distance from the surface, in voxels.
  float confidence = 0.0f;
};

}  // namespace orb360
