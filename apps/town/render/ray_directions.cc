#include "apps/town/render/ray_directions.h"

#include "nn/base/check.h"

namespace orb360::town {

RayDirections::RayDirections(int width, int height, size_t samples, bool normalizes)
    : width_(width),
      samples_(samples),
      normalizes_(normalizes),
      columns_((static_cast<size_t>(width) + 1) * samples),
      rows_(static_cast<size_t>(height) + 2) {
  ORB360_CHECK(samples <= kMaximumSamples, samples);
}

RayDirections RayDirections::OfPanorama(const EquirectangularCamera& camera,
                                        const Eigen::Quaterniond& world_from_camera,
                                        Pattern pattern) {
  // A bearing is cos(latitude) times the one at its longitude on the horizon, plus
  // sin(latitude) times the upward axis; that holds beyond the poles as well.
  RayDirections rays(camera.width(), camera.height(), pattern.size(), false);
  rays.upward_ = (world_from_camera * Eigen::Vector3d::UnitZ()).cast<float>();
  for (int column = 0; column <= camera.width(); ++column) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      rays.columns_[static_cast<size_t>(column) * pattern.size() + sample] =
          (world_from_camera * camera.Bearing({column + pattern[sample][0], camera.cy()}))
              .cast<float>();
    }
  }
  for (int row = -1; row <= camera.height(); ++row) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      const Eigen::Vector3d bearing = camera.Bearing({camera.cx(), row + pattern[sample][1]});
      rays.rows_[static_cast<size_t>(row + 1)][sample] = {static_cast<float>(-bearing.x()),
                                                          static_cast<float>(bearing.z())};
    }
  }
  return rays;
}

RayDirections RayDirections::OfCubeFace(int size, const Eigen::Quaterniond& world_from_face,
                                        Pattern pattern) {
  RayDirections rays(size, size, pattern.size(), true);
  rays.upward_ = (world_from_face * Eigen::Vector3d::UnitZ()).cast<float>();
  for (int column = 0; column <= size; ++column) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      const double right = 2 * (column + pattern[sample][0]) / size - 1;
      rays.columns_[static_cast<size_t>(column) * pattern.size() + sample] =
          (world_from_face * Eigen::Vector3d(-1, right, 0)).cast<float>();
    }
  }
  for (int row = -1; row <= size; ++row) {
    for (size_t sample = 0; sample < pattern.size(); ++sample) {
      rays.rows_[static_cast<size_t>(row + 1)][sample] = {
          1, static_cast<float>(1 - 2 * (row + pattern[sample][1]) / size)};
    }
  }
  return rays;
}

}  // namespace orb360::town
