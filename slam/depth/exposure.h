#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/depth/dense_view.h"

namespace orb360 {

struct ExposureOptions {
  /// Number of earlier views with which each view is compared.
  int max_neighbours = 3;
  /// Every so many pixels of a row and of a column are compared.
  int spacing = 8;
  /// Largest difference of ln(range) between two views of one surface.
  double max_range_difference = 0.03;
  /// Gray values of a pixel and of those around it, in both views: darker ones are noise and
  /// brighter ones are saturated.
  double min_value = 10;
  double max_value = 245;
  /// Least number of pixels of one surface that two views must have in common.
  int min_common = 50;
  /// Standard deviation of the logarithm of a gain before anything is seen, and of the ratio
  /// between two views that have many pixels in common.
  double gain_sigma = 0.5;
  double ratio_sigma = 0.02;
};

/// Returns the numbers by which the values of blue, green and red of each view are multiplied so
/// that overlapping views show surfaces in the same colours (gain compensation; Brown and Lowe
/// 2007). A camera's automatic exposure and white balance change from frame to frame, and so the
/// colours of a cloud would change from keyframe to keyframe. The gains minimize the differences of
/// the logarithms between views, and are 1 in the (geometric) mean of views that see each other.
/// `step`, if given, is called before each view; what it throws is passed on.
std::vector<Eigen::Array3f> EstimateGains(std::span<const DenseView> views, const DepthLoader& load,
                                          const ExposureOptions& options,
                                          const std::function<void()>& step = nullptr);

}  // namespace orb360
