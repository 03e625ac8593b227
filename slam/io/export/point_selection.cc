#include "slam/io/export/point_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "slam/io/ply.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Bits of each coordinate in a key.
constexpr int kKeyBits = 21;
constexpr double kKeyRange = 1 << (kKeyBits - 1);  // cubes on each side of the origin

bool HasKey(const Eigen::Vector3d& position, double size) {
  return (position / size).cwiseAbs().maxCoeff() < kKeyRange;
}

uint64_t KeyOf(const Eigen::Vector3d& position, double size) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    key = key << kKeyBits | static_cast<uint64_t>(std::floor(position(axis) / size) + kKeyRange);
  }
  return key;
}

}  // namespace

SparseModel KeepMostObserved(SparseModel model, size_t max_points) {
  const size_t count = model.points.size();
  if (count <= max_points) return model;
  std::vector<int> observed(count, 0);
  for (const PosedFrame& frame : model.frames) {
    for (const PointObservation& seen : frame.observations) {
      ++observed[static_cast<size_t>(seen.point)];
    }
  }
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater(), [&](size_t p) { return observed[p]; });
  std::vector<int32_t> number(count, -1);
  for (size_t i = 0; i < max_points; ++i) number[order[i]] = 0;
  std::vector<ColoredLandmark> points;
  for (size_t p = 0; p < count; ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<int32_t>(points.size());
    points.push_back(model.points[p]);
  }
  model.points = std::move(points);
  for (PosedFrame& frame : model.frames) {
    std::erase_if(frame.observations, [&](PointObservation& seen) {
      seen.point = number[static_cast<size_t>(seen.point)];
      return seen.point < 0;
    });
  }
  return model;
}

CloudThinning::CloudThinning(size_t max_points) : max_points_(max_points) {
  ORB360_CHECK(max_points > 0);
}

void CloudThinning::Add(const ColoredLandmark& point) {
  if (!point.position.allFinite()) return;
  AddCube({point.position, Eigen::Vector3d(point.color[0], point.color[1], point.color[2]), 1.0});
  while (cubes_.size() > 2 * max_points_) Coarsen(2.0);
}

void CloudThinning::AddCube(const Cube& cube) {
  const Eigen::Vector3d position = cube.position / cube.count;
  while (!HasKey(position, size_)) Coarsen(2.0);
  Cube& sum = cubes_[KeyOf(position, size_)];
  sum.position += cube.position;
  sum.color += cube.color;
  sum.count += cube.count;
}

void CloudThinning::Coarsen(double factor) {
  // In the order of their keys, so that the sums do not depend on the order of the hash table.
  std::vector<std::pair<uint64_t, Cube>> cubes(cubes_.begin(), cubes_.end());
  std::ranges::sort(cubes, {}, &std::pair<uint64_t, Cube>::first);
  cubes_.clear();
  size_ *= factor;
  for (const auto& [key, cube] : cubes) AddCube(cube);
}

std::vector<ColoredLandmark> CloudThinning::Take() {
  // Smaller steps than before, so that the result has nearly as many points as it may have.
  while (cubes_.size() > max_points_) Coarsen(std::exp2(0.125));
  std::vector<std::pair<uint64_t, Cube>> cubes(cubes_.begin(), cubes_.end());
  std::ranges::sort(cubes, {}, &std::pair<uint64_t, Cube>::first);
  cubes_.clear();
  std::vector<ColoredLandmark> points;
  points.reserve(cubes.size());
  for (const auto& [key, cube] : cubes) {
    const Eigen::Vector3d color = cube.color / cube.count;
    ColoredLandmark& point = points.emplace_back();
    point.position = cube.position / cube.count;
    for (size_t c = 0; c < 3; ++c) {
      point.color[c] = static_cast<uint8_t>(std::lround(color(static_cast<int>(c))));
    }
  }
  return points;
}

std::vector<ColoredLandmark> ReadThinnedCloud(const std::filesystem::path& path,
                                              size_t max_points) {
  CloudThinning thinning(max_points);
  ReadCloudPoints(path, [&](const SurfacePoint& point) {
    thinning.Add({point.position.cast<double>(), point.rgb});
  });
  return thinning.Take();
}

}  // namespace orb360
