#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// Gray values around a point on a square grid.
struct Patch {
  /// Number of samples that are compared on each side of the centre. One more is stored for their
  /// gradient.
  static constexpr int kRadius = 5;
  static constexpr int kWidth = 2 * kRadius + 3;
  std::array<uint8_t, kWidth * kWidth> gray;  // row by row
};

/// Growth of the inverse range of a patch's surface from sample to sample, as a fraction of the
/// inverse range at the centre. It is 0 where the surface faces the camera, and constant on a
/// plane.
struct PatchSlope {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // inverse of its covariance
};

}  // namespace orb360
