#include "slam/scale/correlated_noise.h"

#include <cmath>

#include <orb360/nn/base/check.h>

namespace orb360 {

double Whiten(std::span<const double> times, std::span<const double> white_factors,
              const CorrelatedNoise& noise, Eigen::MatrixXd* values) {
  const double fraction = noise.correlated_fraction;
  ORB360_CHECK(static_cast<Eigen::Index>(times.size()) == values->rows() &&
                   white_factors.size() == times.size(),
               times.size(), white_factors.size(), values->rows());
  ORB360_CHECK(fraction >= 0 && fraction < 1 && noise.correlation_time > 0, fraction,
               noise.correlation_time);
  const double gain_of_state = std::sqrt(fraction);
  Eigen::RowVectorXd state = Eigen::RowVectorXd::Zero(values->cols());
  double variance = 1;  // of the state, which is stationary before the first row
  double log_determinant = 0;
  for (Eigen::Index i = 0; i < values->rows(); ++i) {
    const auto at = static_cast<size_t>(i);
    if (i > 0) {
      const double kept = std::exp(-(times[at] - times[at - 1]) / noise.correlation_time);
      state *= kept;
      variance = kept * kept * variance + (1 - kept * kept);
    }
    const double innovation_variance = fraction * variance + (1 - fraction) * white_factors[at];
    const double gain = variance * gain_of_state / innovation_variance;
    const Eigen::RowVectorXd innovation = values->row(i) - gain_of_state * state;
    state += gain * innovation;
    variance -= gain * gain_of_state * variance;
    values->row(i) = innovation / std::sqrt(innovation_variance);
    log_determinant += std::log(innovation_variance);
  }
  return log_determinant;
}

}  // namespace orb360
