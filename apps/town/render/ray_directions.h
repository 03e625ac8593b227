#pragma once

#include <array>
#include <span>
#include <vector>

#include "apps/town/world/mesh.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/rigid3.h"

namespace orb360::town {

/// The rays through the pixels of a picture, several to a pixel: their directions are built from a
/// table over the columns and one over the rows.
class RayDirections {
 public:
  /// Positions in a pixel, [0, 1) from its left and upper side.
  using Pattern = std::span<const std::array<double, 2>>;

  static RayDirections OfPanorama(const EquirectangularCamera& camera,
                                  const Eigen::Quaterniond& world_from_camera, Pattern pattern);
  /// A square picture with a field of view of 90 degrees; its camera looks along -x, y to the
  /// right, z up.
  static RayDirections OfCubeFace(int size, const Eigen::Quaterniond& world_from_face,
                                  Pattern pattern);

  int width() const { return width_; }
  int height() const { return static_cast<int>(rows_.size()) - 2; }

  /// The unit direction through a sample of a pixel, which may also lie in the column right of the
  /// picture, in the row above or in the one below.
  Vector3f At(int column, int row, size_t sample) const {
    const Row& weights = rows_[static_cast<size_t>(row + 1)][sample];
    const Vector3f direction =
        weights.along * columns_[static_cast<size_t>(column) * samples_ + sample] +
        weights.up * upward_;
    return normalizes_ ? direction.normalized() : direction;
  }

 private:
  static constexpr size_t kMaximumSamples = 4;

  /// direction = along * table over the columns + up * upward.
  struct Row {
    float along;
    float up;
  };

  RayDirections(int width, int height, size_t samples, bool normalizes);

  int width_;
  size_t samples_;
  bool normalizes_;
  std::vector<Vector3f> columns_;  // by column and sample
  std::vector<std::array<Row, kMaximumSamples>> rows_;
  Vector3f upward_;
};

}  // namespace orb360::town
