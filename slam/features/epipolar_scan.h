#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace orb360 {

/// Bearings as columns, for scans over all of them. Bearings that are close on the sphere are
/// stored together in cells, and cells far from a given arc are skipped. Columns have one vector of
/// padding at their end.
class BearingColumns {
 public:
  static constexpr int kMaxLanes = 16;  // of the longest vector

  BearingColumns(std::span<const Eigen::Vector3d> bearings, std::span<const double> sigmas);

  int index(int position) const { return index_[position]; }  // in what the columns were made from
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  const float* variance() const { return variance_.data(); }  // of the angle, rad^2
  float max_variance() const { return max_variance_; }

  /// Circles on the sphere, one around the bearings of each cell.
  struct Cells {
    std::vector<float> x, y, z;       // centre
    std::vector<float> sine, cosine;  // of the radius
    std::vector<int> first;           // position of a cell's first bearing, and the end
  };
  const Cells& cells() const { return cells_; }

 private:
  void EncloseCells();

  std::vector<int> index_;
  std::vector<float> x_, y_, z_, variance_;
  float max_variance_ = 0;
  Cells cells_;
};

/// The arc in camera 2 on which the match of a bearing of camera 1 lies: near its epipolar plane,
/// from the direction of a point at infinity towards the epipole, where the range is zero.
struct EpipolarArc {
  Eigen::Vector3d normal;    // unit, of the epipolar plane
  Eigen::Vector3d infinity;  // unit: the bearing of camera 1, turned into camera 2
  Eigen::Vector3d epipole;   // unit: the centre of camera 1 in camera 2
  double variance = 0;       // of the bearing of camera 1, rad^2
  double max_sigmas = 0;     // distance from the plane, in standard deviations of both bearings
  double max_parallax = 0;   // length of the arc, rad, below pi/2
  double max_epipole_cosine = 1;  // matches nearer to the epipole or its antipode are left out
};

/// Replaces `indices` by the indices of the bearings on the arc, in the order of the columns.
void FindOnArc(const BearingColumns& bearings, const EpipolarArc& arc, std::vector<int>* indices);

}  // namespace orb360
