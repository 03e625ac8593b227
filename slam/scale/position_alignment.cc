#include "slam/scale/position_alignment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "nn/base/statistics.h"
#include "slam/scale/alignment_problem.h"
#include "slam/scale/clock_offset_search.h"
#include "slam/scale/fix_noise_average.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using Eigen::Vector3d;

constexpr int kRounds = 15;      // Gauss-Newton from a candidate
constexpr int kFinalRounds = 3;  // with the model of the noise
// A fit whose distances are larger than both is of another path: stated standard deviations, and a
// fraction of the extent of the path, which may be bent by drift.
constexpr double kMaxDistanceSigmas = 5.0;
constexpr double kMaxDistanceFraction = 0.05;
// The fixes must spread by as many standard deviations.
constexpr double kMinSpreadSigmas = 2.0;
constexpr double kMaxScaleSigma = 1.0;  // a factor of e
// Errors of receivers are alike for seconds: one independent fix in this time, at most.
constexpr double kIndependentTime = 10.0;
// Difference of the logarithms of two likelihoods (three standard deviations) below which two clock
// offsets are equally good.
constexpr double kClearDifference = 4.5;
// Smaller distances between fixes and path, in stated standard deviations, are equally good.
constexpr double kLeastDistanceSigmas = 0.3;

/// A candidate after refinement with white noise.
struct Candidate {
  AlignmentState state;
  AlignmentProblem problem;
  double median_distance = 0;
  double clock_sigma = 0;
  double duration = 0;  // seconds with fixes
};

std::optional<Candidate> Refine(AlignmentProblem problem, double clock) {
  std::optional<AlignmentState> start = StartAt(&problem, clock);
  if (!start) return std::nullopt;
  Candidate candidate{*start, problem};
  for (int round = 0; round < kRounds; ++round) {
    LinearizedFixes fixes = Linearize(candidate.problem, candidate.state);
    if (fixes.times.size() < kMinAlignmentFixes) return std::nullopt;
    candidate.median_distance = Reweight(&fixes);
    candidate.duration = fixes.times.back() - fixes.times.front();
    NormalEquations normal = PriorInformation(candidate.problem, candidate.state, fixes);
    for (size_t i = 0; i < fixes.times.size(); ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        normal.Add(fixes.rows[i].row(axis), fixes.residuals[i][axis], fixes.sigmas[i]);
      }
    }
    const Eigen::LDLT<AlignmentMatrix> factor(normal.information);
    Apply(factor.solve(normal.right), &candidate.state);
    candidate.clock_sigma =
        std::sqrt(factor.solve(AlignmentVector::Unit(kClockUnknown))[kClockUnknown]);
  }
  if (!(std::isfinite(candidate.state.scale) && candidate.state.scale > 0)) return std::nullopt;
  // The last step may have moved fixes off the ends of the path.
  const size_t count = Linearize(candidate.problem, candidate.state).times.size();
  return count < kMinAlignmentFixes ? std::nullopt : std::optional(candidate);
}

/// Root mean square distance of the fixes from their mean, horizontally; metres.
double Spread(const LinearizedFixes& fixes, const Vector3d& translation) {
  double sum = 0;
  for (size_t i = 0; i < fixes.times.size(); ++i) {
    const Vector3d fix = fixes.residuals[i] + fixes.rows[i].col(0) + translation;
    sum += (fix - translation).head<2>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(fixes.times.size()));
}

/// Solves with the model of the noise, and fills in what is stated. `common_sigma`: the median of
/// the stated standard deviations, metres. Contract: enough fixes lie on the path.
PositionAlignment Estimate(Candidate* candidate, double common_sigma) {
  AlignmentState& state = candidate->state;
  AveragedSolution solution;
  LinearizedFixes fixes;
  double median_distance = 0;
  for (int round = 0; round < kFinalRounds; ++round) {
    fixes = Linearize(candidate->problem, state);
    if (fixes.times.size() < kMinAlignmentFixes) break;
    median_distance = Reweight(&fixes);
    const NormalEquations normal = PriorInformation(candidate->problem, state, fixes);
    const auto count = static_cast<Eigen::Index>(fixes.times.size());
    std::vector<double> white_factors;
    for (const double sigma : fixes.sigmas) {
      white_factors.push_back(sigma * sigma / (common_sigma * common_sigma));
    }
    NoisyRows rows{fixes.times, white_factors, Eigen::MatrixXd(count, kAlignmentUnknowns + 1),
                   Eigen::MatrixXd(count, kAlignmentUnknowns + 1)};
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<size_t>(i);
      for (int axis = 0; axis < 2; ++axis) {
        Eigen::MatrixXd& matrix = axis == 0 ? rows.east : rows.north;
        matrix.row(i).head<kAlignmentUnknowns>() = fixes.rows[at].row(axis) / common_sigma;
        matrix(i, kAlignmentUnknowns) = fixes.residuals[at][axis] / common_sigma;
      }
    }
    solution = AverageOverNoise(rows, normal.information, normal.right);
    Apply(solution.mean, &state);
  }
  PositionAlignment result;
  const Eigen::MatrixXd& covariance = solution.covariance;
  result.local_from_path = {
      state.scale, state.rotation,
      state.translation - state.scale * (state.rotation * candidate->problem.center)};
  const auto sigma = [&](int i) { return std::sqrt(covariance(i, i)); };
  result.log_scale_sigma = sigma(0);
  result.tilt_sigma = std::max(sigma(1), sigma(2));
  result.heading_sigma = sigma(3);
  result.center = candidate->problem.center;
  result.horizontal_sigma = std::max(sigma(4), sigma(5));
  const bool has_height = std::ranges::any_of(
      fixes.vertical_sigmas, [](double vertical) { return std::isfinite(vertical); });
  result.vertical_sigma = has_height ? sigma(6) : std::numeric_limits<double>::infinity();
  result.clock_offset = state.clock;
  result.clock_offset_sigma =
      candidate->problem.positions->clock_offset_sigma == 0 ? 0.0 : sigma(kClockUnknown);
  result.noise = {solution.factor * common_sigma, solution.correlated_fraction,
                  solution.correlation_time};
  result.median_distance = median_distance;
  result.num_fixes = static_cast<int>(fixes.times.size());
  return result;
}

/// Why no clock offset is possible.
AlignmentFailure WhyNoCandidate(const AlignmentProblem& problem, double sigma) {
  const Positions& positions = *problem.positions;
  const bool is_unknown = !std::isfinite(positions.clock_offset_sigma);
  std::vector<Vector3d> places;
  Vector3d sum = Vector3d::Zero();
  for (const PositionFix& fix : positions.fixes) {
    const double timestamp = fix.timestamp + positions.clock_offset;
    if (!is_unknown && !Interpolate(problem.path, timestamp, kMaxPathGap)) continue;
    places.push_back(fix.position);
    sum += fix.position;
  }
  if (places.size() < kMinAlignmentFixes) return AlignmentFailure::kTooFewFixes;
  double squares = 0;
  for (const Vector3d& place : places) {
    squares += (place - sum / static_cast<double>(places.size())).head<2>().squaredNorm();
  }
  const double spread = std::sqrt(squares / static_cast<double>(places.size()));
  return spread < kMinSpreadSigmas * sigma ? AlignmentFailure::kStandstill
                                           : AlignmentFailure::kNotThisPath;
}

}  // namespace

AlignmentResult AlignPositions(std::span<const PathPoint> path, const Positions& positions,
                               const UpDirection& up,
                               const std::optional<ScaleMeasurement>& scale) {
  std::vector<double> sigmas;
  for (const PositionFix& fix : positions.fixes) {
    ORB360_CHECK(fix.IsValid(), fix.timestamp, fix.sigma, fix.vertical_sigma);
    sigmas.push_back(fix.sigma);
  }
  if (sigmas.size() < kMinAlignmentFixes) return {{}, AlignmentFailure::kTooFewFixes};
  const double sigma = Median(sigmas);
  const AlignmentProblem problem{path, &positions, up, scale};
  std::vector<PathPoint> levelled(path.begin(), path.end());
  const auto level = Eigen::Quaterniond::FromTwoVectors(up.up, Vector3d::UnitZ());
  for (PathPoint& point : levelled) point.position = level * point.position;

  std::vector<Candidate> candidates;
  for (const double clock : FindClockOffsets(levelled, positions)) {
    if (auto candidate = Refine(problem, clock)) candidates.push_back(std::move(*candidate));
  }
  if (candidates.empty()) return {{}, WhyNoCandidate(problem, sigma)};
  const auto best = std::ranges::min_element(candidates, {}, &Candidate::median_distance);
  const LinearizedFixes fixes = Linearize(best->problem, best->state);
  const double spread = Spread(fixes, best->state.translation);
  if (spread < kMinSpreadSigmas * sigma) return {{}, AlignmentFailure::kStandstill};
  const double distance = best->median_distance;
  if (distance > std::max(kMaxDistanceSigmas * sigma, kMaxDistanceFraction * spread)) {
    return {{}, AlignmentFailure::kNotThisPath, distance};
  }
  for (const Candidate& other : candidates) {
    const double apart = std::abs(other.state.clock - best->state.clock);
    if (apart < 1.0 + 3 * std::min(other.clock_sigma, best->clock_sigma)) continue;
    const double independent = std::min<double>(best->duration / kIndependentTime,
                                                static_cast<double>(fixes.times.size()));
    const double least = kLeastDistanceSigmas * sigma;
    const double ratio = std::max(other.median_distance, least) / std::max(distance, least);
    if (2 * independent * std::log(ratio) < kClearDifference) {
      return {{}, AlignmentFailure::kManyOffsets};
    }
  }
  AlignmentResult result{Estimate(&*best, sigma)};
  if (!(result.alignment->log_scale_sigma < kMaxScaleSigma)) {
    return {{}, AlignmentFailure::kStandstill};
  }
  return result;
}

}  // namespace orb360
