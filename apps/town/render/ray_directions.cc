#include "apps/town/render/ray_directions.h"

#include <cmath>

namespace orb360::town {

RayDirections::RayDirections(int width, int height, size_t samples, bool normalizes)
    : width_(width),
      samples_(samples),
      normalizes_(normalizes),
      row_weights_(static_cast<size_t>(height)) {
  for (std::vector<float>& axis : columns_)
    axis.assign(static_cast<size_t>(width) * samples + kPacket, 0.0F);
}

RayDirections RayDirections::OfPanorama(const EquirectangularCamera& camera,
                                        const Eigen::Quaterniond& world_from_camera,
                                        Pattern pattern) {
  // A bearing is cos(latitude) times the one at its longitude on the horizon, plus
  // sin(latitude) times the upward axis.
  RayDirections rays(camera.width(), camera.height(), pattern.size(), false);
  rays.upward_ = (world_from_camera * Eigen::Vector3d::UnitZ()).cast<float>();
  for (int column = 0; column < camera.width(); ++column) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      const Eigen::Vector3d horizontal =
          world_from_camera * camera.Bearing({column + pattern[sample][0], camera.cy()});
      for (int axis = 0; axis < 3; ++axis) {
        rays.columns_[static_cast<size_t>(axis)][static_cast<size_t>(column) * pattern.size() +
                                                 sample] = static_cast<float>(horizontal[axis]);
      }
    }
  }
  for (int row = 0; row < camera.height(); ++row) {
    for (size_t lane = 0; lane < kPacket; ++lane) {
      const Eigen::Vector3d bearing =
          camera.Bearing({camera.cx(), row + pattern[lane % pattern.size()][1]});
      RowWeights& weights = rays.row_weights_[static_cast<size_t>(row)];
      weights.along[lane] = static_cast<float>(-bearing.x());
      weights.up[lane] = static_cast<float>(bearing.z());
    }
  }
  return rays;
}

RayDirections RayDirections::OfCubeFace(int size, const Eigen::Quaterniond& world_from_face,
                                        Pattern pattern) {
  RayDirections rays(size, size, pattern.size(), true);
  rays.upward_ = (world_from_face * Eigen::Vector3d::UnitZ()).cast<float>();
  for (int column = 0; column < size; ++column) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      const double right = 2 * (column + pattern[sample][0]) / size - 1;
      const Eigen::Vector3d direction = world_from_face * Eigen::Vector3d(-1, right, 0);
      for (int axis = 0; axis < 3; ++axis) {
        rays.columns_[static_cast<size_t>(axis)][static_cast<size_t>(column) * pattern.size() +
                                                 sample] = static_cast<float>(direction[axis]);
      }
    }
  }
  for (int row = 0; row < size; ++row) {
    for (size_t lane = 0; lane < kPacket; ++lane) {
      RowWeights& weights = rays.row_weights_[static_cast<size_t>(row)];
      weights.along[lane] = 1;
      weights.up[lane] =
          static_cast<float>(1 - 2 * (row + pattern[lane % pattern.size()][1]) / size);
    }
  }
  return rays;
}

void RayDirections::Fill(int column, int row, RTCRay16* rays) const {
  const size_t first = static_cast<size_t>(column) * samples_;
  const RowWeights& weights = row_weights_[static_cast<size_t>(row)];
  float* const directions[3] = {rays->dir_x, rays->dir_y, rays->dir_z};
  for (int axis = 0; axis < 3; ++axis) {
    const float* table = columns_[static_cast<size_t>(axis)].data() + first;
    float* direction = directions[axis];
    for (size_t lane = 0; lane < kPacket; ++lane)
      direction[lane] = weights.along[lane] * table[lane] + weights.up[lane] * upward_[axis];
  }
  if (!normalizes_) return;
  for (size_t lane = 0; lane < kPacket; ++lane) {
    const float scale = 1 / std::sqrt(rays->dir_x[lane] * rays->dir_x[lane] +
                                      rays->dir_y[lane] * rays->dir_y[lane] +
                                      rays->dir_z[lane] * rays->dir_z[lane]);
    rays->dir_x[lane] *= scale;
    rays->dir_y[lane] *= scale;
    rays->dir_z[lane] *= scale;
  }
}

}  // namespace orb360::town
