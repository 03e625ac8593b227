#include "slam/scale/fix_noise_average.h"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "slam/scale/correlated_noise.h"

namespace orb360 {
namespace {

// Each equally probable before anything is measured. Fractions near 1 are close to one another,
// because there the white noise, which alone shows in differences of neighbours, changes quickly.
constexpr std::array kFractions = {0.0, 0.05, 0.1,  0.2,  0.35, 0.5,  0.65,
                                   0.8, 0.9,  0.95, 0.98, 0.99, 0.997};
constexpr std::array kTimes = {5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, 640.0};  // seconds
// Receivers and phones are wrong about their own accuracy by a factor of three either way.
const double kLogFactorSigma = std::log(3.0);
constexpr double kLogFactorStep = 0.2;
constexpr int kLogFactorSteps = 23;  // to a factor of 100 either way

/// One model with its solution.
struct Solved {
  double cost = 0;  // -2 ln of the probability, but for a constant
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double log_factor = 0, fraction = 0, log_time = 0;
};

}  // namespace

AveragedSolution AverageOverNoise(const NoisyRows& rows, const Eigen::MatrixXd& information,
                                  const Eigen::VectorXd& right) {
  const Eigen::Index unknowns = information.rows();
  const auto count = static_cast<double>(rows.times.size());
  double sum_of_times = 0;
  for (const double time : kTimes) sum_of_times += time;
  std::vector<Solved> models;
  for (const double fraction : kFractions) {
    for (const double time : kTimes) {
      if (fraction == 0 && time != kTimes.front()) continue;  // White noise has no such time.
      Eigen::MatrixXd east = rows.east;
      Eigen::MatrixXd north = rows.north;
      const double log_determinant =
          Whiten(rows.times, rows.white_factors, {fraction, time}, &east) +
          Whiten(rows.times, rows.white_factors, {fraction, time}, &north);
      const Eigen::MatrixXd gram = east.transpose() * east + north.transpose() * north;
      // A short track hardly tells how long errors last. Long times are preferred, which leaves the
      // standard deviations rather too large than too small. White noise stands for all times.
      const double prior = -2 * std::log(fraction == 0 ? sum_of_times : time);
      for (int step = -kLogFactorSteps; step <= kLogFactorSteps; ++step) {
        const double log_factor = kLogFactorStep * step;
        const double weight = std::exp(-2 * log_factor);
        const Eigen::MatrixXd normal =
            weight * gram.topLeftCorner(unknowns, unknowns) + information;
        const Eigen::VectorXd vector = weight * gram.topRightCorner(unknowns, 1) + right;
        const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
        Solved solved;
        solved.mean = factor.solve(vector);
        const double in_prior = log_factor / kLogFactorSigma;
        solved.cost = 4 * count * log_factor + log_determinant + weight * gram(unknowns, unknowns) -
                      vector.dot(solved.mean) + factor.vectorD().array().abs().log().sum() +
                      in_prior * in_prior + prior;
        solved.covariance = factor.solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
        solved.log_factor = log_factor;
        solved.fraction = fraction;
        solved.log_time = std::log(time);
        models.push_back(std::move(solved));
      }
    }
  }
  double least = models.front().cost;
  for (const Solved& model : models) least = std::min(least, model.cost);
  AveragedSolution average{Eigen::VectorXd::Zero(unknowns),
                           Eigen::MatrixXd::Zero(unknowns, unknowns)};
  double total = 0;
  double log_factor = 0;
  double log_time = 0;
  double total_of_time = 0;
  for (const Solved& model : models) {
    const double weight = std::exp(-0.5 * (model.cost - least));
    total += weight;
    average.mean += weight * model.mean;
    log_factor += weight * model.log_factor;
    average.correlated_fraction += weight * model.fraction;
    log_time += weight * model.fraction * model.log_time;
    total_of_time += weight * model.fraction;
  }
  average.mean /= total;
  for (const Solved& model : models) {
    const double weight = std::exp(-0.5 * (model.cost - least)) / total;
    const Eigen::VectorXd apart = model.mean - average.mean;
    average.covariance += weight * (model.covariance + apart * apart.transpose());
  }
  average.factor = std::exp(log_factor / total);
  average.correlated_fraction /= total;
  if (total_of_time > 0) average.correlation_time = std::exp(log_time / total_of_time);
  return average;
}

}  // namespace orb360
