#pragma once

#include <filesystem>
#include <random>
#include <vector>

#include "slam/io/ply.h"

namespace orb360 {

/// Points on the ground and on a wall, some of them twice, with a colour that tells which it is.
inline std::vector<SurfacePoint> Surfaces(int count) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> along(-20, 30), up(0, 8);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    SurfacePoint point;
    point.position = i % 3 == 0 ? Eigen::Vector3f(along(random), 4, up(random))
                                : Eigen::Vector3f(along(random), along(random), -1.6f);
    if (i % 50 == 49) point.position = points.back().position;
    point.normal = i % 3 == 0 ? Eigen::Vector3f(0, -1, 0) : Eigen::Vector3f(0, 0, 1);
    point.rgb = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8),
                 static_cast<std::uint8_t>(i >> 16)};
    point.confidence = 0.01f + 0.99f * static_cast<float>(i % 100) / 100;
    points.push_back(point);
  }
  return points;
}

/// Which of the points it is.
inline int NumberOf(const SurfacePoint& point) {
  return point.rgb[0] | point.rgb[1] << 8 | point.rgb[2] << 16;
}

inline void WriteSurfaces(const std::filesystem::path& path,
                          const std::vector<SurfacePoint>& points) {
  SurfacePlyWriter writer(path, 0.05);
  writer.Append(points);
  writer.Commit();
}

}  // namespace orb360
