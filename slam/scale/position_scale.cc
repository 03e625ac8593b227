#include "slam/scale/position_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/alignment.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kMaxGap = 2.0;            // seconds between points of the path
constexpr double kCorrelationTime = 10.0;  // seconds within which errors of fixes are alike
constexpr size_t kMinFixes = 3;            // as many as a similarity has unknowns for
constexpr int kRounds = 10;                // of reweighting; its weights settle within a few
constexpr double kHuberSigmas = 2.0;       // distance from which a fix counts less
constexpr double kMaxSigma = 1.0;          // of ln(scale): a factor of e
constexpr double kMaxConflict = 3.0;       // standard deviations of the difference

/// The fixes during the path, and where the path was then.
struct Pairs {
  std::vector<Eigen::Vector3d> path;
  std::vector<Eigen::Vector3d> fixes;
  std::vector<double> sigmas;
  std::vector<double> timestamps;
};

Pairs MakePairs(std::span<const PathPoint> path, std::span<const PositionFix> fixes) {
  Pairs pairs;
  for (const PositionFix& fix : fixes) {
    ORB360_CHECK(fix.IsValid(), fix.timestamp, fix.sigma);
    const auto after = std::ranges::upper_bound(path, fix.timestamp, {}, &PathPoint::timestamp);
    if (after == path.begin() || after == path.end()) continue;
    const PathPoint& before = *(after - 1);
    const double gap = after->timestamp - before.timestamp;
    if (gap > kMaxGap) continue;
    const double fraction = (fix.timestamp - before.timestamp) / gap;
    pairs.path.emplace_back(before.position + fraction * (after->position - before.position));
    pairs.fixes.push_back(fix.position);
    pairs.sigmas.push_back(fix.sigma);
    pairs.timestamps.push_back(fix.timestamp);
  }
  return pairs;
}

/// How many fixes each fix shares its information with, itself included.
std::vector<double> CountAlike(const std::vector<double>& timestamps) {
  std::vector<double> counts;
  for (const double timestamp : timestamps) {
    counts.push_back(static_cast<double>(std::ranges::count_if(timestamps, [&](double other) {
      return std::abs(other - timestamp) < 0.5 * kCorrelationTime;
    })));
  }
  return counts;
}

}  // namespace

std::optional<ScaleMeasurement> MeasureScaleByPositions(std::span<const PathPoint> path,
                                                        std::span<const PositionFix> fixes) {
  const Pairs pairs = MakePairs(path, fixes);
  const size_t count = pairs.path.size();
  if (count < kMinFixes) return std::nullopt;
  const std::vector<double> alike = CountAlike(pairs.timestamps);
  std::vector<double> weights(count);
  for (size_t i = 0; i < count; ++i)
    weights[i] = 1 / (pairs.sigmas[i] * pairs.sigmas[i] * alike[i]);
  const std::vector<double> informations = weights;
  std::optional<Similarity3> similarity;
  double chi_squared = 0;
  double num_independent = 0;
  for (int round = 0; round < kRounds; ++round) {
    similarity = AlignSimilarity(pairs.path, pairs.fixes, weights);
    if (!similarity) return std::nullopt;
    chi_squared = 0;
    num_independent = 0;
    for (size_t i = 0; i < count; ++i) {
      const double error = (*similarity * pairs.path[i] - pairs.fixes[i]).norm() / pairs.sigmas[i];
      const double loss = error <= kHuberSigmas ? 1.0 : kHuberSigmas / error;
      weights[i] = informations[i] * loss;
      chi_squared += loss * error * error / alike[i];
      num_independent += loss / alike[i];
    }
  }
  // The derivative of a fix by ln(scale) is its distance from the centre of all.
  double total = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < count; ++i) {
    total += weights[i];
    center += weights[i] * pairs.path[i];
  }
  center /= total;
  double information = 0;
  for (size_t i = 0; i < count; ++i) {
    const double lever = similarity->scale * (pairs.path[i] - center).norm();
    information += weights[i] * lever * lever;
  }
  constexpr double kUnknowns = 7;
  const double freedom = std::max(1.0, 3 * num_independent - kUnknowns);
  const double sigma = std::sqrt(std::max(1.0, chi_squared / freedom) / information);
  if (!(sigma < kMaxSigma)) return std::nullopt;
  return ScaleMeasurement{std::log(similarity->scale), sigma};
}

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
