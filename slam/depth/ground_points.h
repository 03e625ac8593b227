#pragma once

#include <Eigen/Core>

#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {

struct GroundPointOptions {
  /// Angle below the horizon from which on the ground is taken to be level, radians.
  double min_depression = 0.785;
  /// Side of the squares that get one point, pixels: larger than that of what stereo measures, so
  /// that the points of the prior are the fewer ones.
  int spacing = 12;
  /// Nothing is added where at least this fraction of the squares has a point: what was measured
  /// tells the network the height, and some wrong points are among it.
  double min_known = 0.1;
  /// Standard deviation of ln(range): ground is not level, and a height is not kept exactly.
  double relative_error = 0.1;
  /// The confidence of a point follows from its error as that of a landmark.
  SparseDepthOptions sparse = {};
};

/// Adds points on level ground below a camera at `height` over it, in the unit of the sparse depth,
/// where nothing was measured there: a network that gets far points only takes the ground to be far
/// as well. `up` is the normal of the ground, camera frame, unit. Returns whether points were
/// added.
bool AddGroundPoints(const Eigen::Vector3d& up, double height, const GroundPointOptions& options,
                     SparseDepth* sparse);

}  // namespace orb360
