#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "slam/evaluation/trajectory_error.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360 {

/// Scale of an estimate along its path: true over estimated length of windows of the true path (1
/// is perfect, as for the scale factor of the whole). It does not depend on the alignment.
///
/// Both lengths are sums of the same chords, from pose to pose at least kSpacing of the true path
/// apart, with linear interpolation between them. The steps from frame to frame would add up noise:
/// with a standard deviation s in each direction, the difference of two positions has the variance
/// 2 s^2 in each of the two directions across the path, which lengthens a step of length L by
/// 2 s^2 / L on average. For s = 4 mm that is 0.3 % of steps of 0.1 m, but 0.001 % of chords of 2
/// m; for 45 mm (a drive with few near surfaces) 0.4 % of steps of 1 m, but 0.1 % of
/// chords of 2 m. The straight distance between the ends of a window would not add noise either,
/// but it depends on the shape of the path: that of a hairpin is nearly zero. Chords of 2 m follow
/// what a carrier drives or walks, and because both trajectories are cut at the same poses, what
/// the chords cut off at a bend cancels. A camera that stays within 2 m of a place does not
/// advance.
///
/// The noise of a window's ends remains: s sqrt(2) / kWindow of the ratio, 0.03 % for 4 mm and 0.3
/// % for 45 mm, and sqrt(2) times that in the difference of two windows.
///
/// Windows that reach across a gap are not measured, because the motion there was not estimated but
/// assumed. Two windows on different sides of a gap are compared: the estimate states one unit of
/// length for all of its poses, and a change of scale at a loss is drift.
struct LocalScale {
  static constexpr double kWindow = 20.0;  ///< Metres of the true path.
  static constexpr double kStep = 5.0;     ///< Between the starts of neighbouring windows, metres.
  static constexpr double kSpacing = 2.0;  ///< Least length of a chord, metres.
  static constexpr double kDriftLength = 100.0;  ///< Between the windows that are compared, metres.

  struct Window {
    /// True path from the first true pose to the start of the window, metres: a multiple of kStep.
    double begin = 0.0;
    /// True over estimated length. An estimate that does not move counts as 1e-6 of the true
    /// length, so that the ratio is finite.
    double ratio = 1.0;
    double begin_time = 0.0;  ///< When the true path is at the start of the window, seconds.
    double end_time = 0.0;    ///< The same for its end.
  };
  std::vector<Window> windows;  ///< Ordered by `begin`; never empty.
  double min = 1.0;             ///< Smallest ratio.
  double max = 1.0;             ///< Largest ratio.
  /// |Difference of ln(ratio)| of two windows that begin kDriftLength apart, median and largest.
  /// None where no two windows do, as on a path shorter than 120 m.
  std::optional<double> drift_median;
  std::optional<double> drift_worst;
  /// Largest |ratio - 1| of windows of kDriftLength. None on shorter paths.
  std::optional<double> worst_deviation;
};

/// Measures the local scale of `pairs` (PairPoses of `truth` and the estimate). A gap is between
/// two pairs with more true poses from one to the other than 1.5 times the median of all pairs, so
/// that the estimate may have a lower rate than the truth but a single lost frame is a gap; and
/// before each time in `map_changes`, seconds: there the estimate continues in another map.
/// Returns nullopt if no window of kWindow lies between gaps.
std::optional<LocalScale> MeasureLocalScale(std::span<const StampedPose> truth,
                                            std::span<const PosePair> pairs,
                                            std::span<const double> map_changes = {});

}  // namespace orb360
