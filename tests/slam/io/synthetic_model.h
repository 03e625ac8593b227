#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slam/io/sparse_model.h"

namespace orb360 {

/// The size of a synthetic model.
struct SyntheticModelSize {
  int frames = 12;
  int points_per_keyframe = 40;
  int width = 1024;  // pixels; the height is half of it
};

/// A camera that is carried along a line and turns, and points around its way, each of which is
/// observed without noise by the six keyframes next to it. Every third frame is no keyframe. The
/// pixels are computed from the definition of the panorama in the optical frame (x right, y down, z
/// forward): longitude atan2(x, z), latitude atan2(-y, hypot(x, z)).
inline SparseModel MakeSyntheticModel(const SyntheticModelSize& size = {}) {
  SparseModel model{size.width, size.width / 2, {}, {}};
  uint32_t state = 1;  // of a linear congruential generator, the same on every machine
  const auto uniform = [&state](double low, double high) {
    state = 1664525u * state + 1013904223u;
    return low + (high - low) * (state / 4294967296.0);
  };
  Eigen::Matrix3d world_from_level;  // the optical frame of a level camera that looks along x
  world_from_level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  constexpr double kStep = 0.25;  // m
  for (int i = 0; i < size.frames; ++i) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d(0.1, 1, 0.2).normalized()));
    PosedFrame frame{i,
                     0.1 * i,
                     0,
                     i % 3 != 2,
                     {Eigen::Quaterniond(world_from_level) * turn, {kStep * i, 0.02 * i, 0.1}},
                     {}};
    model.frames.push_back(frame);
  }
  constexpr int kReach = 9;  // frames; six of nine are keyframes
  for (int i = 0; i < size.frames; ++i) {
    if (!model.frames[static_cast<size_t>(i)].is_keyframe) continue;
    for (int p = 0; p < size.points_per_keyframe; ++p) {
      const auto number = static_cast<int32_t>(model.points.size());
      const double angle = uniform(0, 2 * std::numbers::pi);
      const double range = uniform(2, 12);
      const Eigen::Vector3d position(kStep * i + range * std::cos(angle), range * std::sin(angle),
                                     uniform(-2, 5));
      model.points.push_back({position, {static_cast<uint8_t>(p), 100, static_cast<uint8_t>(i)}});
      for (int k = std::max(0, i - kReach / 2); k < std::min(size.frames, i + kReach / 2 + 1);
           ++k) {
        PosedFrame& frame = model.frames[static_cast<size_t>(k)];
        if (!frame.is_keyframe) continue;
        const Eigen::Vector3d q = frame.world_from_optical.Inverse() * position;
        const double longitude = std::atan2(q.x(), q.z());
        const double latitude = std::atan2(-q.y(), std::hypot(q.x(), q.z()));
        const double u = (longitude / (2 * std::numbers::pi) + 0.5) * model.width;
        const double v = (0.5 - latitude / std::numbers::pi) * model.height;
        frame.observations.push_back({{static_cast<float>(u), static_cast<float>(v)}, number});
      }
    }
  }
  return model;
}

}  // namespace orb360
