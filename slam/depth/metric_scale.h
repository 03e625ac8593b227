#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/depth/dense_depth.h"

namespace orb360 {

/// How many metres one unit of a map is: ln, with its standard deviation.
struct ScaleMeasurement {
  double log_scale = 0;
  double sigma = 0;
};

struct MetricScaleOptions {
  /// Pixels are ground where the network gives it this probability.
  double min_ground_probability = 0.5;
  /// Standard deviation of ln(scale) from one keyframe when its ground is perfectly flat: roads are
  /// not, and cameras sway.
  double height_sigma = 0.01;
  /// Largest difference in ln(scale) between the plane and the network's own guess: where they
  /// disagree more, neither is believed.
  double max_disagreement = 0.3;
};

/// What completed depth tells of the scale: the plane through the ground must lie `camera_height`
/// (metres) below the camera. `ground`: CV_32F, the probability of each pixel to show it, or empty
/// where the network does not tell: then all pixels below the horizon are asked. `up`: unit vector
/// in the camera. `guess`: ln of metres per unit from the network's global branch, where it has
/// one. Empty where no plane is found, or where it and the guess disagree.
std::optional<ScaleMeasurement> MeasureScale(const DenseDepth& depth, const cv::Mat& ground,
                                             double camera_height, const Eigen::Vector3d& up,
                                             std::optional<double> guess,
                                             const MetricScaleOptions& options);

/// Several keyframes' measurements of one scale: the median, weighted by certainty; its standard
/// deviation from their spread around it, or from their own where that is larger. Empty for none.
std::optional<ScaleMeasurement> FuseScales(std::span<const ScaleMeasurement> measurements);

}  // namespace orb360
