#include "slam/scale/scale_measurement.h"

#include <algorithm>
#include <cmath>

namespace orb360 {
namespace {

constexpr double kMaxConflict = 3.0;  // standard deviations of the difference

}  // namespace

ScaleMeasurement FuseScales(const ScaleMeasurement& a, const ScaleMeasurement& b,
                            bool* is_conflict) {
  const double variance_a = a.sigma * a.sigma;
  const double variance_b = b.sigma * b.sigma;
  const double difference = a.log_scale - b.log_scale;
  const double variance_sum = variance_a + variance_b;
  *is_conflict = difference * difference > kMaxConflict * kMaxConflict * variance_sum;
  if (!*is_conflict) {
    return {(variance_b * a.log_scale + variance_a * b.log_scale) / variance_sum,
            std::sqrt(variance_a * variance_b / variance_sum)};
  }
  // The mean square error about the result is the same whichever of both is right.
  const double fraction =
      std::clamp(0.5 + (variance_b - variance_a) / (2 * difference * difference), 0.0, 1.0);
  const double mean = b.log_scale + (1 - fraction) * difference;
  const double from_a = mean - a.log_scale;
  const double from_b = mean - b.log_scale;
  return {mean, std::sqrt(std::max(variance_a + from_a * from_a, variance_b + from_b * from_b))};
}

}  // namespace orb360
