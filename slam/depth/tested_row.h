#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// Least sine of the angle at which a surface is assumed to be seen, because the normal is not
/// known better.
inline constexpr float kMinIncidence = 0.15f;

/// Largest number of points that vector instructions handle at once.
inline constexpr size_t kMaxLanes = 16;

/// Pixels of one row of a keyframe that are tested together, one in each element of the arrays.
struct TestedRow {
  using Array = std::vector<float>;

  int row = 0;
  size_t size = 0;
  std::vector<std::int32_t> column;
  std::array<Array, 3> bearing;  // camera frame, unit
  Array range;                   // world units
  std::array<Array, 3> normal;   // camera frame, unit, towards the camera; zero where there is none
  Array variance;  // of the point along its normal, to be expected; 0: it is not to be confirmed
  // What source views and the point's own keyframe say of the points:
  Array support;      // how many see the same surface there
  Array conflict;     // how many look through it
  Array information;  // sum of 1 / variance, its own and of those that support
  Array best;         // the largest of these
  Array shift;        // sum of the offsets along the normal, each times its information

  void Clear(int new_row);
  void Add(int new_column, const Eigen::Vector3f& new_bearing, float new_range);
  /// Completes the row: fills the arrays up to a multiple of kMaxLanes and sets everything except
  /// the positions of the points to zero.
  void Close();
};

}  // namespace orb360
