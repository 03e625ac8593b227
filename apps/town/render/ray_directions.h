#pragma once

#include <array>
#include <span>
#include <vector>

#include "apps/town/render/ray_scene.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/rigid3.h"

namespace orb360::town {

/// The rays through the pixels of a picture, several to a pixel, by the packet. Directions are
/// built from a table over the columns and one over the rows.
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
  int height() const { return static_cast<int>(row_weights_.size()); }

  /// Sets the unit directions of a packet: all samples of the first pixel, then of the next to the
  /// right, and so on. Lanes beyond the end of the row get any direction.
  void Fill(int column, int row, RTCRay16* rays) const;

 private:
  RayDirections(int width, int height, size_t samples, bool normalizes);

  /// direction = along * table over the columns + up * upward, for each lane.
  struct RowWeights {
    alignas(64) std::array<float, kPacket> along;
    alignas(64) std::array<float, kPacket> up;
  };

  int width_;
  size_t samples_;
  bool normalizes_;
  std::array<std::vector<float>, 3> columns_;  // x, y, z by column and sample
  std::vector<RowWeights> row_weights_;
  Vector3f upward_;
};

}  // namespace orb360::town
