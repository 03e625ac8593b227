#include "slam/evaluation/depth_calibration.h"

#include <algorithm>
#include <cmath>

#include "slam/evaluation/depth_error.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

void DepthCalibration::Add(double truth, double estimate, double confidence, double solid_angle) {
  if (!(estimate > 0 && confidence > 0)) return;
  const double step = std::round(255 * (1 - std::min(confidence, 1.0)));
  Sums& sums = levels_[static_cast<size_t>(step)];
  sums.weight += solid_angle;
  sums.stated += solid_angle * (1 / confidence - 1);
  sums.observed += solid_angle * std::abs(estimate - truth) / truth;
}

DepthCalibration& DepthCalibration::operator+=(const DepthCalibration& other) {
  for (size_t i = 0; i < levels_.size(); ++i) {
    levels_[i].weight += other.levels_[i].weight;
    levels_[i].stated += other.levels_[i].stated;
    levels_[i].observed += other.levels_[i].observed;
  }
  return *this;
}

double DepthCalibration::solid_angle() const {
  double total = 0;
  for (const Sums& sums : levels_) total += sums.weight;
  return total;
}

DepthCalibration::Means DepthCalibration::MeansBetween(double from, double to) const {
  const double total = solid_angle();
  Sums inside;
  double begin = 0;
  for (const Sums& sums : levels_) {
    const double end = begin + sums.weight;
    // The pixels of one level are all alike, so that a part of them has their means.
    const double part = std::min(end, to * total) - std::max(begin, from * total);
    if (part > 0) {
      inside.weight += part;
      inside.stated += part / sums.weight * sums.stated;
      inside.observed += part / sums.weight * sums.observed;
    }
    begin = end;
  }
  return {inside.stated / inside.weight, inside.observed / inside.weight};
}

std::array<DepthCalibration::Means, 10> DepthCalibration::Tenths() const {
  std::array<Means, 10> tenths{};
  for (size_t i = 0; i < tenths.size(); ++i) {
    tenths[i] = MeansBetween(static_cast<double>(i) / 10, static_cast<double>(i + 1) / 10);
  }
  return tenths;
}

double DepthCalibration::Risk(double coverage) const {
  ORB360_CHECK(coverage > 0 && coverage <= 1, coverage);
  return MeansBetween(0, coverage).observed;
}

DepthCalibration CompareConfidence(const cv::Mat& truth, const cv::Mat& estimate,
                                   const cv::Mat& confidence) {
  for (const cv::Mat& image : {truth, estimate, confidence}) {
    ORB360_CHECK(image.type() == CV_32FC1 && image.size() == truth.size(), image.type(),
                 image.size(), truth.size());
  }
  DepthCalibration calibration;
  for (int row = 0; row < truth.rows; ++row) {
    const double solid_angle = PixelSolidAngle(row, truth.size());
    for (int column = 0; column < truth.cols; ++column) {
      const double range = truth.at<float>(row, column);
      if (!(range > 0 && range <= DepthErrors::kRangeEnds.back())) continue;
      calibration.Add(range, estimate.at<float>(row, column), confidence.at<float>(row, column),
                      solid_angle);
    }
  }
  return calibration;
}

}  // namespace orb360
