#pragma once

#include <span>

#include <Eigen/Core>

#include "slam/scale/position_alignment.h"

namespace orb360 {

/// A linear least-squares problem whose noise is not known exactly: `rows` times the unknowns is
/// `residuals`, in two horizontal directions with the same noise, in units of a common standard
/// deviation.
struct NoisyRows {
  std::span<const double> times;  ///< Of the rows, seconds, ascending.
  /// Variance of the white noise of each row, over the square of the common standard deviation.
  std::span<const double> white_factors;
  Eigen::MatrixXd east, north;  ///< One row a fix: the unknowns' coefficients, then the residual.
};

/// The unknowns, averaged over all models of the noise.
struct AveragedSolution {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double factor = 1;  ///< Of the common standard deviation; geometric mean.
  double correlated_fraction = 0;
  double correlation_time = 0;  ///< Geometric mean.
};

/// Solves the rows together with further information on the unknowns, `information` * x = `right`
/// (normal equations; their sum with those of the rows must be positive definite).
AveragedSolution AverageOverNoise(const NoisyRows& rows, const Eigen::MatrixXd& information,
                                  const Eigen::VectorXd& right);

}  // namespace orb360
