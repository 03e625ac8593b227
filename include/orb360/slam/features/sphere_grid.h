#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// Unit vectors sorted into cells of about equal solid angle, to find those near a direction. Rings
/// of equal height in latitude (about the +Z axis) have a number of cells in proportion to their
/// circumference.
class SphereGrid {
 public:
  /// An empty grid, in which no bearing is found.
  SphereGrid() = default;
  /// Sorts unit vectors, whose indices Query returns.
  explicit SphereGrid(std::span<const Eigen::Vector3d> bearings);

  /// Appends the indices of all bearings within `radius` (radians) of the unit vector `center`, and
  /// of some bearings just outside, in ascending order within each cell. Radii beyond 90 degrees
  /// return all bearings.
  void Query(const Eigen::Vector3d& center, double radius, std::vector<int>* indices) const;

 private:
  int CellInRing(int ring, double longitude) const;

  std::vector<int> ring_start_;  // first cell of each ring; one more entry than rings
  std::vector<int> cell_start_;  // first entry of each cell in order_; one more than cells
  std::vector<int> order_;
};

}  // namespace orb360
