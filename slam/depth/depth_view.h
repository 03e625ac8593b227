#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <orb360/slam/depth/dense_depth.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

/// Dense depth of a keyframe in the world, prepared for comparison with others. A pixel without a
/// range or without confidence is unknown. Errors are those of FusionConfidence.
class DepthView {
 public:
  /// `min_error` (positive) is the least expected error of ln(range) of a pixel, however confident
  /// the network is. Contract: images have an even width and at least 8 x 4 pixels.
  DepthView(const DenseDepth& depth, const Rigid3& world_from_camera, double min_error);

  int width() const { return width_; }
  int height() const { return height_; }
  const Rigid3& world_from_camera() const { return world_from_camera_; }
  float min_error() const { return min_error_; }

  /// Range in world units; 0 where unknown.
  float range(int row, int column) const {
    const float inverse = inverse_ranges_[IndexOf(row, column)];
    return inverse > 0 ? 1.0f / inverse : 0.0f;
  }
  /// Expected error of ln(range).
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

  /// 1 / range, row by row, which is nearly linear between pixels of one plane; 0 where unknown.
  std::span<const float> inverse_ranges() const { return inverse_ranges_; }
  /// Confidence times 255, row by row, four pixels per word, the first one in the lowest byte.
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

/// Number of columns between neighbours in a row that are as far apart as rows are at the equator.
int ColumnStep(double cosine_of_latitude);

}  // namespace orb360
