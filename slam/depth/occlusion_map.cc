#include "slam/depth/occlusion_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <orb360/nn/base/check.h>

namespace orb360 {

OcclusionMap::OcclusionMap(const DepthView& source, const DepthView& reference,
                           const OcclusionMapOptions& options)
    : cell_(options.cell),
      width_((reference.width() + options.cell - 1) / options.cell),
      height_((reference.height() + options.cell - 1) / options.cell) {
  ORB360_CHECK(source.width() == reference.width() && source.height() == reference.height(),
               source.width(), source.height());
  ORB360_CHECK(options.cell > 0, options.cell);
  constexpr float kPi = std::numbers::pi_v<float>;
  const Rigid3 reference_from_source =
      reference.world_from_camera().Inverse() * source.world_from_camera();
  const Eigen::Matrix3f rotation = reference_from_source.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = reference_from_source.translation.cast<float>();
  const float cells_per_radian =
      static_cast<float>(reference.height()) / (kPi * static_cast<float>(cell_));
  const auto max_error = static_cast<float>(options.max_error);

  // The farthest range of each cell; 0 where no surface was seen.
  std::vector<float> farthest(static_cast<size_t>(width_) * static_cast<size_t>(height_), 0.0f);
  const int step = std::max(1, cell_ / 2);
  for (int row = step / 2; row < source.height(); row += step) {
    for (int column = step / 2; column < source.width(); column += step) {
      const float range = source.range(row, column);
      if (!(range > 0) || source.error(row, column) > max_error) continue;
      const Eigen::Vector3f point =
          range * (rotation * source.BearingOf(row, column)) + translation;
      const float distance = point.norm();
      const float longitude = std::atan2(point.y(), -point.x());
      const float latitude = std::asin(std::clamp(point.z() / distance, -1.0f, 1.0f));
      const int x =
          std::clamp(static_cast<int>((longitude + kPi) * cells_per_radian), 0, width_ - 1);
      const int y =
          std::clamp(static_cast<int>((0.5f * kPi - latitude) * cells_per_radian), 0, height_ - 1);
      float& cell = farthest[static_cast<size_t>(y * width_ + x)];
      cell = std::max(cell, distance);
    }
  }
  ranges_.assign(farthest.size(), std::numeric_limits<float>::infinity());
  for (int y = 1; y + 1 < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      float most = 0;
      int num_seen = 0;
      for (const int row : {y - 1, y, y + 1}) {
        for (const int column : {(x + width_ - 1) % width_, x, (x + 1) % width_}) {
          const float range = farthest[static_cast<size_t>(row * width_ + column)];
          most = std::max(most, range);
          num_seen += range > 0;
        }
      }
      if (num_seen >= options.min_cells) ranges_[static_cast<size_t>(y * width_ + x)] = most;
    }
  }
}

}  // namespace orb360
