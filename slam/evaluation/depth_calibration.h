#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace orb360 {

/// How far the errors of ranges agree with those that their confidence states, by confidence, in
/// steps of 1/255. Each pixel is weighted by its solid angle.
class DepthCalibration {
 public:
  /// Of some pixels, weighted by their solid angle.
  struct Means {
    double stated;    // mean expected relative error, 1 / confidence - 1
    double observed;  // mean of |error| / truth
  };

  /// `confidence` is in 0..1; without any nothing is stated, and the pixel is left out.
  void Add(double truth, double estimate, double confidence, double solid_angle);
  DepthCalibration& operator+=(const DepthCalibration& other);

  /// Solid angle of what has a range and a confidence, sr.
  double solid_angle() const;
  /// Of all. NaN without pixels.
  Means Mean() const { return MeansBetween(0, 1); }
  /// Of each tenth of what has a range, by solid angle, from the most to the least confident. NaN
  /// without pixels.
  std::array<Means, 10> Tenths() const;
  /// Mean of |error| / truth of the given most confident fraction (in (0, 1]) of what has a range:
  /// the risk of this coverage (Geifman, El-Yaniv 2017).
  double Risk(double coverage) const;

 private:
  struct Sums {
    double weight = 0;
    double stated = 0;
    double observed = 0;
  };

  /// Means between two fractions, from the most confident on.
  Means MeansBetween(double from, double to) const;

  std::array<Sums, 256> levels_{};  // the most confident first
};

/// Compares the errors of an equirectangular range image with its confidence (CV_32FC1 all three,
/// metres, 0 for none). Ranges beyond those of DepthErrors are ignored.
DepthCalibration CompareConfidence(const cv::Mat& truth, const cv::Mat& estimate,
                                   const cv::Mat& confidence);

}  // namespace orb360
