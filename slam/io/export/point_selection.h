#pragma once

#include <cstdint>
#include <filesystem>
#include <unordered_map>
#include <vector>

#include "slam/io/sparse_model.h"

namespace orb360 {

/// Returns the model with at most `max_points` of its points: those that most frames observe, and
/// of equal ones the first. Observations of the others are removed.
SparseModel KeepMostObserved(SparseModel model, size_t max_points);

/// Thins a cloud of any size to a number of points in memory for twice that number. Each point is
/// the mean of those in one cube of space. Cubes begin with a millimetre (of a map that is not
/// metric, a thousandth of its unit) and grow until there are few enough.
class CloudThinning {
 public:
  explicit CloudThinning(size_t max_points);

  void Add(const ColoredLandmark& point);
  /// Returns the points, ordered by cube.
  std::vector<ColoredLandmark> Take();

 private:
  /// Sums over the points in a cube.
  struct Cube {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    double count = 0;
  };

  /// Makes cubes `factor` times as large and adds those together that have become one.
  void Coarsen(double factor);
  void AddCube(const Cube& cube);

  const size_t max_points_;
  double size_ = 1e-3;  // side of the cubes
  std::unordered_map<uint64_t, Cube> cubes_;
};

/// Reads the cloud of a run (`cloud.ply`, of either kind) and thins it to `max_points`. Throws
/// UserError where the file is missing or is no such cloud.
std::vector<ColoredLandmark> ReadThinnedCloud(const std::filesystem::path& path, size_t max_points);

}  // namespace orb360
