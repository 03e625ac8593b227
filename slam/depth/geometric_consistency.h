#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/depth_view.h"

namespace orb360 {

struct GeometricConsistencyOptions {
  /// Number of source views that must see the point where it is.
  int min_support = 2;
  /// A point is rejected if more than this fraction of the source views with a verdict contradict
  /// it.
  double max_conflict_fraction = 0.34;
  /// Two ranges agree if they differ by at most this many expected errors plus relative_tolerance
  /// of the range.
  double tolerance_errors = 2.5;
  /// Additional tolerance as a fraction of the range, for the errors of poses and sampling and for
  /// errors that the confidence does not state.
  double relative_tolerance = 0.01;
  /// Least expected error of ln(range), however confident the network is.
  double min_error = 0.01;
  /// A point is left to another keyframe that sees it and has a variance smaller by this factor.
  double redundant_ratio = 4.0;
  /// Errors of keyframes at the same place are correlated. All keyframes together are at most this
  /// many times as certain as the best of them (in variance).
  double max_independent = 4.0;
};

/// A point of a keyframe that is geometrically consistent with others.
struct ConsistentPoint {
  Eigen::Vector3d position;  // world
  Eigen::Vector3f normal;    // world, unit, towards the camera
  float error;               // along the normal, to be expected, world units
  int row;                   // its pixel
  int column;
};

/// Selection of the pixels of a keyframe that are tested.
struct SamplingOptions {
  /// Spacing of points, world units. Where pixels are closer to each other than half of it, every
  /// second, fourth, ... pixel is taken. Fewer pixels of a row are taken near the poles, so that
  /// every direction has the same density.
  double spacing = 0.05;
  /// Points farther away are left out, world units.
  double max_range = 30.0;
  /// Points with a larger expected error are left out, world units. What cannot become that certain
  /// by any agreement is not tested, and supports no point of another view either.
  double max_error = 0.2;
};

/// Returns the points of a keyframe that are geometrically consistent with the others. A point is
/// compared with what each source view sees in its direction. The same surface supports it, a
/// nearer one hides it, and a farther one (also in the pixels around) contradicts it. Moving
/// objects and depth invented by the network are contradicted or lack support. Where keyframes
/// agree, the point moves along its normal to the mean of all, weighted by certainty.
///
/// The points are ordered by row, then column, and are the same for any number of OpenMP threads.
std::vector<ConsistentPoint> FindConsistentPoints(const DepthView& view,
                                                  std::span<const DepthView* const> others,
                                                  const GeometricConsistencyOptions& options,
                                                  const SamplingOptions& sampling,
                                                  int num_threads = 1);

}  // namespace orb360
