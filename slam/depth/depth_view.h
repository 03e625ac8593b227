#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/dense_depth.h"
#include "slam/geometry/rigid3.h"

namespace orb360 {

/// Dense depth of a keyframe in the world, ready for comparison with others. A pixel without a
/// range or without confidence is unknown.
class DepthView {
 public:
  /// `scale`: world units in one unit of the ranges. `min_error`: the least error of ln(range) to
  /// be expected of a pixel, however confident the network is; positive. Contract: images of an
  /// even width, 8 x 4 or more.
  DepthView(const DenseDepth& depth, const Rigid3& world_from_camera, double scale,
            double min_error);

  int width() const { return width_; }
  int height() const { return height_; }
  const Rigid3& world_from_camera() const { return world_from_camera_; }
  float min_error() const { return min_error_; }

  /// World units; 0 where unknown.
  float range(int row, int column) const {
    const float inverse = inverse_ranges_[IndexOf(row, column)];
    return inverse > 0 ? 1.0f / inverse : 0.0f;
  }
  /// Of ln(range), to be expected.
  float error(int row, int column) const {
    const size_t index = IndexOf(row, column);
    return errors_[levels_[index / 4] >> (8 * (index % 4)) & 255];
  }

  /// Unit vector through a pixel's centre, camera frame.
  Eigen::Vector3f BearingOf(int row, int column) const {
    const Eigen::Vector2f& longitude = longitudes_[static_cast<size_t>(column)];
    const Eigen::Vector2f& latitude = latitudes_[static_cast<size_t>(row)];
    return {-latitude.x() * longitude.x(), latitude.x() * longitude.y(), latitude.y()};
  }

  /// Row by row: 1 / range, nearly linear between pixels that see one plane; 0 where unknown.
  std::span<const float> inverse_ranges() const { return inverse_ranges_; }
  /// Row by row: confidence times 255, four pixels a word, the first in its lowest byte.
  std::span<const std::uint32_t> confidence_levels() const { return levels_; }

 private:
  size_t IndexOf(int row, int column) const {
    return static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column);
  }

  int width_;
  int height_;
  Rigid3 world_from_camera_;
  float min_error_;
  std::vector<float> inverse_ranges_;
  std::vector<std::uint32_t> levels_;
  std::array<float, 256> errors_{};          // by level of confidence
  std::vector<Eigen::Vector2f> longitudes_;  // cosine and sine of each column's longitude
  std::vector<Eigen::Vector2f> latitudes_;   // of each row's latitude
};

/// Columns between neighbours in a row that are as far apart as rows are at the equator.
int ColumnStep(double cosine_of_latitude);

}  // namespace orb360
