#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace orb360 {

/// Gray values around a point, on a square grid.
struct Patch {
  /// Samples on each side of the centre that are compared; one more is kept for their gradient.
  static constexpr int kRadius = 5;
  static constexpr int kWidth = 2 * kRadius + 3;
  std::array<uint8_t, kWidth * kWidth> gray;  // row by row
};

/// How the inverse range of the surface in a patch grows from sample to sample, as a share of that
/// at the centre: 0 where the surface faces the camera. A plane's does so evenly.
struct PatchSlope {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // inverse of its covariance
};

}  // namespace orb360
