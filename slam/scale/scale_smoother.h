#pragma once

#include <optional>
#include <span>
#include <vector>

namespace orb360 {

/// A keyframe on a path whose scale is estimated. The state is x = ln(true length / length in the
/// map) of the path near the keyframe.
struct ScaleNode {
  double path_length = 0;     ///< From the node before it: its weight in the mean.
  double drift_variance = 0;  ///< Variance of x minus the x of the node before it, positive.
  double measured = 0;        ///< What was measured of x.
  double sigma = 0;           ///< Standard deviation of that; 0 where nothing was measured.
};

struct SmoothedScale {
  std::vector<double> log_scale;  ///< x of each node.
  std::vector<double> sigma;      ///< Standard deviation of each x.
  double mean = 0;                ///< Mean of x, weighted by path length.
  double mean_sigma = 0;          ///< Standard deviation of the mean.
  /// How far the measurements vary along the path beyond their standard deviations: the root of the
  /// mean square, weighted by path length as the mean. Each is the median of the five around it, so
  /// that a stretch of what the mean takes for outliers counts, but single ones do not. 0 where
  /// there are fewer than five.
  double spread = 0;
};

/// Estimates the scale along a path from all of its measurements (a random walk with measurements,
/// solved as one tridiagonal system, which is what a Rauch-Tung-Striebel smoother does). Outliers
/// are weighted down by Huber's loss. Where the measurements contradict each other or the drift by
/// more than their standard deviations, all standard deviations are widened by the square root of
/// the reduced chi-squared (Birge's ratio). Empty where nothing was measured.
std::optional<SmoothedScale> SmoothScale(std::span<const ScaleNode> nodes);

}  // namespace orb360
