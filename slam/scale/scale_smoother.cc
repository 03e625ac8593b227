#include "slam/scale/scale_smoother.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kRounds = 8;
// Standard deviations from which a residual weighs less.
constexpr double kHuber = 2.0;

/// The information matrix of all states, positive definite and tridiagonal, as L D L^T.
class Tridiagonal {
 public:
  /// `weights`: of the nodes' measurements.
  Tridiagonal(std::span<const ScaleNode> nodes, std::span<const double> weights)
      : pivot_(nodes.size(), 0.0), below_(nodes.size(), 0.0) {
    std::vector<double> diagonal(nodes.size(), 0.0);
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].sigma > 0) diagonal[i] += weights[i] / (nodes[i].sigma * nodes[i].sigma);
      if (i == 0) continue;
      const double information = 1 / nodes[i].drift_variance;
      diagonal[i - 1] += information;
      diagonal[i] += information;
    }
    for (size_t i = 0; i < nodes.size(); ++i) {
      pivot_[i] = diagonal[i];
      if (i == 0) continue;
      const double off_diagonal = -1 / nodes[i].drift_variance;
      below_[i] = off_diagonal / pivot_[i - 1];
      pivot_[i] -= below_[i] * off_diagonal;
    }
  }

  std::vector<double> Solve(std::vector<double> right) const {
    for (size_t i = 1; i < right.size(); ++i) right[i] -= below_[i] * right[i - 1];
    for (size_t i = 0; i < right.size(); ++i) right[i] /= pivot_[i];
    for (size_t i = right.size() - 1; i > 0; --i) right[i - 1] -= below_[i] * right[i];
    return right;
  }

  /// The diagonal of the inverse.
  std::vector<double> Variances() const {
    std::vector<double> variances(pivot_.size());
    for (size_t i = pivot_.size(); i-- > 0;) {
      variances[i] = 1 / pivot_[i];
      if (i + 1 < pivot_.size()) variances[i] += below_[i + 1] * below_[i + 1] * variances[i + 1];
    }
    return variances;
  }

 private:
  std::vector<double> pivot_;  // D
  std::vector<double> below_;  // L(i, i - 1)
};

// SmoothedScale::spread. `share`: weight of each node in the mean.
double Spread(std::span<const ScaleNode> nodes, std::span<const double> share, double mean) {
  constexpr size_t kWindow = 5;
  std::vector<size_t> measured;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].sigma > 0) measured.push_back(i);
  }
  if (measured.size() < kWindow) return 0;
  double sum = 0;
  double weight = 0;
  for (size_t i = 0; i < measured.size(); ++i) {
    // The first and the last ones share a window.
    const size_t first = std::min(i - std::min(i, kWindow / 2), measured.size() - kWindow);
    std::vector<double> near;
    for (size_t k = 0; k < kWindow; ++k) near.push_back(nodes[measured[first + k]].measured);
    const double apart = Median(near) - mean;
    const double sigma = nodes[measured[i]].sigma;
    sum += share[measured[i]] * std::max(0.0, apart * apart - sigma * sigma);
    weight += share[measured[i]];
  }
  return weight > 0 ? std::sqrt(sum / weight) : 0;
}

}  // namespace

std::optional<SmoothedScale> SmoothScale(std::span<const ScaleNode> nodes) {
  const auto is_measured = [](const ScaleNode& node) { return node.sigma > 0; };
  const auto count = std::ranges::count_if(nodes, is_measured);
  if (count == 0) return std::nullopt;
  for (size_t i = 1; i < nodes.size(); ++i) {
    ORB360_CHECK(nodes[i].drift_variance > 0, i, nodes[i].drift_variance);
  }
  std::vector<double> weights(nodes.size(), 1.0);
  SmoothedScale result;
  double sum_of_squares = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> right(nodes.size(), 0.0);
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (is_measured(nodes[i])) {
        right[i] = weights[i] * nodes[i].measured / (nodes[i].sigma * nodes[i].sigma);
      }
    }
    result.log_scale = Tridiagonal(nodes, weights).Solve(std::move(right));
    sum_of_squares = 0;
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (!is_measured(nodes[i])) continue;
      const double residual = std::abs(nodes[i].measured - result.log_scale[i]) / nodes[i].sigma;
      weights[i] = residual > kHuber ? kHuber / residual : 1.0;
      sum_of_squares += weights[i] * residual * residual;
    }
    for (size_t i = 1; i < nodes.size(); ++i) {
      const double drift = result.log_scale[i] - result.log_scale[i - 1];
      sum_of_squares += drift * drift / nodes[i].drift_variance;
    }
  }
  // As many degrees of freedom as measurements and drifts together have more than there are nodes.
  const double birge =
      std::max(1.0, std::sqrt(sum_of_squares / std::max<double>(1.0, count - 1.0)));
  const Tridiagonal information(nodes, weights);
  for (const double variance : information.Variances()) {
    result.sigma.push_back(birge * std::sqrt(variance));
  }
  // A path without length has the scale of its nodes.
  std::vector<double> share(nodes.size());
  const double length =
      std::accumulate(nodes.begin(), nodes.end(), 0.0,
                      [](double sum, const ScaleNode& node) { return sum + node.path_length; });
  for (size_t i = 0; i < nodes.size(); ++i) {
    share[i] = length > 0 ? nodes[i].path_length / length : 1 / static_cast<double>(nodes.size());
  }
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  result.mean = dot(share, result.log_scale);
  result.mean_sigma = birge * std::sqrt(dot(share, information.Solve(share)));
  result.spread = Spread(nodes, share, result.mean);
  return result;
}

}  // namespace orb360
