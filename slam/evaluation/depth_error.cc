#include "slam/evaluation/depth_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <orb360/nn/base/check.h>

namespace orb360 {

double DepthErrorBin::Rmse() const { return std::sqrt(squared / weight); }
double DepthErrorBin::Mae() const { return absolute / weight; }
double DepthErrorBin::AbsRel() const { return relative / weight; }
double DepthErrorBin::Delta125() const { return within_125 / weight; }
double DepthErrorBin::Coverage() const { return weight / truth_weight; }

void DepthErrorBin::Add(double truth, double estimate, double solid_angle) {
  truth_weight += solid_angle;
  if (!(estimate > 0.0)) return;
  const double error = std::abs(estimate - truth);
  weight += solid_angle;
  squared += solid_angle * error * error;
  absolute += solid_angle * error;
  relative += solid_angle * error / truth;
  if (std::max(estimate / truth, truth / estimate) < 1.25) within_125 += solid_angle;
}

DepthErrorBin& DepthErrorBin::operator+=(const DepthErrorBin& other) {
  truth_weight += other.truth_weight;
  weight += other.weight;
  squared += other.squared;
  absolute += other.absolute;
  relative += other.relative;
  within_125 += other.within_125;
  return *this;
}

DepthErrors& DepthErrors::operator+=(const DepthErrors& other) {
  total += other.total;
  for (size_t i = 0; i < by_range.size(); ++i) by_range[i] += other.by_range[i];
  for (size_t i = 0; i < by_latitude.size(); ++i) by_latitude[i] += other.by_latitude[i];
  return *this;
}

double PixelSolidAngle(int row, cv::Size size) {
  // The zone between two latitudes covers 2 pi (sin a - sin b), divided among the row's pixels.
  const double top = std::numbers::pi * (0.5 - static_cast<double>(row) / size.height);
  const double bottom = std::numbers::pi * (0.5 - (row + 1.0) / size.height);
  return 2.0 * std::numbers::pi * (std::sin(top) - std::sin(bottom)) / size.width;
}

DepthErrors CompareDepth(const cv::Mat& truth, const cv::Mat& estimate) {
  ORB360_CHECK(truth.type() == CV_32FC1 && estimate.type() == CV_32FC1, truth.type(),
               estimate.type());
  ORB360_CHECK(truth.size() == estimate.size(), truth.size(), estimate.size());
  DepthErrors errors;
  for (int row = 0; row < truth.rows; ++row) {
    const double solid_angle = PixelSolidAngle(row, truth.size());
    const double height = 1.0 - (row + 0.5) / truth.rows;  // 0 at the nadir, 1 at the zenith.
    DepthErrorBin& band =
        errors.by_latitude[static_cast<size_t>(height * DepthErrors::kLatitudeBands)];
    for (int column = 0; column < truth.cols; ++column) {
      const double true_range = truth.at<float>(row, column);
      const auto end = std::ranges::lower_bound(DepthErrors::kRangeEnds, true_range);
      if (!(true_range > 0.0) || end == DepthErrors::kRangeEnds.end()) continue;
      const double range = estimate.at<float>(row, column);
      errors.total.Add(true_range, range, solid_angle);
      band.Add(true_range, range, solid_angle);
      errors.by_range[static_cast<size_t>(end - DepthErrors::kRangeEnds.begin())].Add(
          true_range, range, solid_angle);
    }
  }
  return errors;
}

}  // namespace orb360
