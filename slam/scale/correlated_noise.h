#pragma once

#include <span>

#include <Eigen/Core>

namespace orb360 {

/// Noise of variance 1: the sum of a first-order Gauss-Markov process, whose correlation decays as
/// exp(-|dt| / correlation_time), and of white noise.
struct CorrelatedNoise {
  double correlated_fraction = 0;  ///< Of the variance, from 0 up to but without 1.
  double correlation_time = 1;     ///< Seconds, positive.
};

/// Replaces the columns of `values` by ones in which this noise is white and of variance 1: the
/// normalized innovations of the Kalman filter of the process, whose transformation is a Cholesky
/// factor of the inverse covariance. Row i belongs to `times[i]`, seconds, in ascending order, and
/// the white part of its noise has `white_factors[i]`, positive, times the variance of the model.
/// Returns the logarithm of the determinant of the covariance. O(rows * columns). Throws
/// ContractError where the sizes differ or the model is out of range.
double Whiten(std::span<const double> times, std::span<const double> white_factors,
              const CorrelatedNoise& noise, Eigen::MatrixXd* values);

}  // namespace orb360
