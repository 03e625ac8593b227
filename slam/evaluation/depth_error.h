#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace orb360 {

/// Errors of estimated ranges. Each pixel is weighted by its solid angle, because rows near the
/// poles are stretched.
struct DepthErrorBin {
  /// Root mean square error, metres.
  double Rmse() const;
  /// Mean absolute error, metres.
  double Mae() const;
  /// Mean of |error| / truth.
  double AbsRel() const;
  /// Fraction with max(estimate / truth, truth / estimate) < 1.25.
  double Delta125() const;
  /// Fraction of the pixels with a true range that have an estimate.
  double Coverage() const;

  void Add(double truth, double estimate, double solid_angle);
  DepthErrorBin& operator+=(const DepthErrorBin& other);

  /// Sums over pixels, weighted by solid angle in steradians. The errors above are NaN without
  /// pixels.
  double truth_weight = 0.0;
  double weight = 0.0;
  double squared = 0.0;
  double absolute = 0.0;
  double relative = 0.0;
  double within_125 = 0.0;
};

/// Depth errors of one image, or the sum over many.
struct DepthErrors {
  /// Upper ends of the bins of true range, metres. Farther pixels are ignored.
  static constexpr std::array<double, 5> kRangeEnds = {5.0, 10.0, 20.0, 40.0, 80.0};
  /// Number of bands of latitude of equal height, the lowest first.
  static constexpr int kLatitudeBands = 6;

  DepthErrorBin total;
  std::array<DepthErrorBin, kRangeEnds.size()> by_range;
  std::array<DepthErrorBin, kLatitudeBands> by_latitude;

  DepthErrors& operator+=(const DepthErrors& other);
};

/// Solid angle of each pixel of a row of an equirectangular image, steradians.
double PixelSolidAngle(int row, cv::Size size);

/// Compares two equirectangular range images of the same size (CV_32FC1, metres, 0 for none).
DepthErrors CompareDepth(const cv::Mat& truth, const cv::Mat& estimate);

}  // namespace orb360
