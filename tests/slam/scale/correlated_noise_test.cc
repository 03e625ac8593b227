#include "slam/scale/correlated_noise.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

TEST(CorrelatedNoise, WhitensAsTheInverseOfTheWholeCovarianceDoes) {
  RandomGeometry random(1);
  const std::vector<double> times = {0, 0.1, 0.5, 3, 3.5, 40, 41, 300};
  const std::vector<double> factors = {1, 1, 1, 0.5, 100, 1, 2, 1};
  const auto count = static_cast<Eigen::Index>(times.size());
  for (const CorrelatedNoise& noise :
       {CorrelatedNoise{0, 10}, CorrelatedNoise{0.5, 10}, CorrelatedNoise{0.98, 100}}) {
    Eigen::MatrixXd values(count, 3);
    for (double& value : values.reshaped()) value = random.Normal(1);
    Eigen::MatrixXd covariance(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index k = 0; k < count; ++k) {
        const double apart = std::abs(times[i] - times[k]);
        covariance(i, k) = noise.correlated_fraction * std::exp(-apart / noise.correlation_time) +
                           (i == k ? (1 - noise.correlated_fraction) * factors[i] : 0);
      }
    }
    const Eigen::MatrixXd expected = values.transpose() * covariance.inverse() * values;
    Eigen::MatrixXd whitened = values;
    const double log_determinant = Whiten(times, factors, noise, &whitened);
    EXPECT_LT((whitened.transpose() * whitened - expected).norm(), 1e-9 * expected.norm());
    EXPECT_NEAR(log_determinant, std::log(covariance.determinant()), 1e-9);
  }
}

TEST(CorrelatedNoise, RefusesModelsOutOfRange) {
  Eigen::MatrixXd values(1, 1);
  values << 1;
  const std::vector<double> times = {0};
  EXPECT_THROW(Whiten(times, times, {1.0, 1.0}, &values), ContractError);
  EXPECT_THROW(Whiten(times, times, {0.5, 0.0}, &values), ContractError);
  EXPECT_THROW(Whiten({}, {}, {0.5, 1.0}, &values), ContractError);
}

}  // namespace
}  // namespace orb360
