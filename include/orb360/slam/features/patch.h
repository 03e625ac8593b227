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
  /// Number of samples that are stored in each row and column.
  static constexpr int kWidth = 2 * kRadius + 3;
  /// Gray values of the samples, row by row.
  std::array<uint8_t, kWidth * kWidth> gray;
};

/// Growth of the inverse range of a patch's surface from sample to sample, as a fraction of the
/// inverse range at the centre. It is 0 where the surface faces the camera, and constant on a
/// plane.
struct PatchSlope {
  /// Estimate of the growth along a row and along a column of samples.
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  /// Inverse of the covariance of the estimate; 0 where nothing is known.
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

}  // namespace orb360
