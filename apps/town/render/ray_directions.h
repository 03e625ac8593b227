#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "apps/town/image/lanes.h"
#include "apps/town/world/mesh.h"
#include <orb360/slam/geometry/camera.h>
#include <orb360/slam/geometry/rigid3.h>

namespace orb360::town {

/// The rays through the pixels of an image, several per pixel. Their directions are computed from a
/// table over the columns and one over the rows.
class RayDirections {
 public:
  /// Positions in a pixel, in [0, 1) from its left and upper side.
  using Pattern = std::span<const std::array<double, 2>>;

  static RayDirections OfPanorama(const EquirectangularCamera& camera,
                                  const Eigen::Quaterniond& world_from_camera, Pattern pattern);
  /// A square image with a field of view of 90 degrees; its camera looks along -x, with y to the
  /// right and z up.
  static RayDirections OfCubeFace(int size, const Eigen::Quaterniond& world_from_face,
                                  Pattern pattern);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Side, in pixels, of the squares of which packets of rays consist.
  static constexpr int kSquare = 4;

  /// Returns the unit direction through a sample of a pixel, which may also lie up to kSquare
  /// columns to the right of the image, in the row above it, or up to kSquare rows below it.
  Vector3f At(int column, int row, size_t sample) const {
    const Row& weights = rows_[sample][static_cast<size_t>(row + 1)];
    const auto i = static_cast<size_t>(column);
    const Columns& columns = columns_[sample];
    const Vector3f direction =
        weights.along * Vector3f(columns.x[i], columns.y[i], columns.z[i]) + weights.up * upward_;
    return normalizes_ ? direction.normalized() : direction;
  }

  /// Returns the directions through one sample of each pixel of a square, row by row. The square
  /// may extend beyond the image by as much.
  void OfSquare(int left, int top, size_t sample, Lanes3* directions) const;

 private:
  /// direction = along * table over the columns + up * upward.
  struct Row {
    float along;
    float up;
  };
  struct Columns {
    std::vector<float> x;
    std::vector<float> y;
    std::vector<float> z;
  };

  RayDirections(int width, int height, bool normalizes);

  void AddSample(const std::function<Eigen::Vector3d(int)>& column,
                 const std::function<Row(int)>& row);

  int width_;
  int height_;
  bool normalizes_;
  std::vector<Columns> columns_;        // by sample; up to kSquare columns beyond the image
  std::vector<std::vector<Row>> rows_;  // by sample, then row + 1; as many rows beyond
  Vector3f upward_;
};

}  // namespace orb360::town
