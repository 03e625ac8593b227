#include "slam/evaluation/scale_calibration.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace orb360 {
namespace {

StampedScale StatedIn(const LocalScale::Window& window, std::span<const StampedScale> stated) {
  const auto begin =
      std::ranges::lower_bound(stated, window.begin_time, {}, &StampedScale::timestamp);
  const auto end = std::ranges::upper_bound(stated, window.end_time, {}, &StampedScale::timestamp);
  if (begin == end) {
    const double middle = 0.5 * (window.begin_time + window.end_time);
    return *std::ranges::min_element(stated, {}, [middle](const StampedScale& scale) {
      return std::abs(scale.timestamp - middle);
    });
  }
  StampedScale mean{0, 0, 0};
  double sum_of_logs = 0;
  for (auto scale = begin; scale != end; ++scale) {
    sum_of_logs += std::log(scale->value);
    mean.sigma += scale->sigma;
  }
  const auto count = static_cast<double>(std::distance(begin, end));
  mean.value = std::exp(sum_of_logs / count);
  mean.sigma /= count;
  return mean;
}

}  // namespace

std::optional<ScaleCalibration> CalibrateScale(const LocalScale& scale,
                                               std::span<const StampedScale> stated) {
  if (stated.empty()) return std::nullopt;
  ScaleCalibration result;
  for (const LocalScale::Window& window : scale.windows) {
    const StampedScale mean = StatedIn(window, stated);
    const double error = std::abs(std::log(window.ratio / mean.value)) / mean.sigma;
    ++result.windows;
    result.normalized_squared_error += error * error;
    result.within_1_sigma += error <= 1;
    result.within_2_sigma += error <= 2;
    result.largest = std::max(result.largest, error);
  }
  result.normalized_squared_error /= result.windows;
  result.within_1_sigma /= result.windows;
  result.within_2_sigma /= result.windows;
  return result;
}

}  // namespace orb360
