#include "slam/scale/alignment_problem.h"

#include <algorithm>
#include <cmath>

#include "nn/base/statistics.h"
#include "slam/scale/clock_offset_search.h"
#include "slam/scale/correlated_noise.h"
#include <orb360/slam/geometry/so3.h>

namespace orb360 {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kCauchySigmas = 4.0;  // distance at which a fix has half its weight
constexpr double kMaxClockStep = 2.0;  // seconds in one round
// Heights of receivers drift; only how far the path is tilted depends on them.
constexpr CorrelatedNoise kVerticalNoise{0.5, 60.0};
// Standard deviations of unknowns of which nothing else is known, so that every problem has one
// solution: metres, seconds.
constexpr double kUnknownHeight = 1e4;
constexpr double kUnknownClock = 1e3;

}  // namespace

LinearizedFixes Linearize(const AlignmentProblem& problem, const AlignmentState& state) {
  LinearizedFixes result;
  const bool is_clock_known = problem.positions->clock_offset_sigma == 0;
  const Matrix3d rotation = state.rotation.toRotationMatrix();
  for (const PositionFix& fix : problem.positions->fixes) {
    const auto at = Interpolate(problem.path, fix.timestamp + state.clock, kMaxPathGap);
    if (!at) continue;
    const Vector3d q = state.scale * (rotation * (at->position - problem.center));
    Eigen::Matrix<double, 3, kAlignmentUnknowns> row;
    row.col(0) = q;
    row.block<3, 3>(0, 1) = -Skew(q);
    row.block<3, 3>(0, 4).setIdentity();
    // A clock that is known is not an unknown.
    row.col(kClockUnknown) =
        is_clock_known ? Vector3d::Zero() : Vector3d(state.scale * (rotation * at->velocity));
    result.times.push_back(fix.timestamp);
    result.residuals.emplace_back(fix.position - q - state.translation);
    result.rows.push_back(row);
    result.sigmas.push_back(fix.sigma);
    result.vertical_sigmas.push_back(fix.vertical_sigma);
  }
  return result;
}

double Reweight(LinearizedFixes* fixes) {
  std::vector<double> horizontal, vertical, distances;
  for (size_t i = 0; i < fixes->times.size(); ++i) {
    const Vector3d& r = fixes->residuals[i];
    distances.push_back(r.head<2>().norm());
    horizontal.push_back(distances.back() / fixes->sigmas[i]);
    if (std::isfinite(fixes->vertical_sigmas[i])) {
      vertical.push_back(std::abs(r.z()) / fixes->vertical_sigmas[i]);
    }
  }
  // Medians of the Rayleigh and of the half-normal distribution with a standard deviation of 1.
  const double spread = std::max(1e-6, Median(std::vector(horizontal)) / 1.1774);
  const double vertical_spread =
      vertical.empty() ? 1.0 : std::max(1e-6, Median(std::vector(vertical)) / 0.6745);
  const auto inflation = [](double error) { return std::hypot(1.0, error / kCauchySigmas); };
  for (size_t i = 0; i < fixes->times.size(); ++i) {
    fixes->sigmas[i] *= inflation(horizontal[i] / spread);
    double& sigma = fixes->vertical_sigmas[i];
    if (!std::isfinite(sigma)) continue;
    const double error = std::abs(fixes->residuals[i].z()) / sigma;
    // A factor of the stated heights is taken from the residuals, where it is larger than 1.
    sigma *= std::max(1.0, vertical_spread) * inflation(error / vertical_spread);
  }
  return Median(distances);
}

NormalEquations PriorInformation(const AlignmentProblem& problem, const AlignmentState& state,
                                 const LinearizedFixes& fixes) {
  NormalEquations normal;
  std::vector<double> times, sigmas, white_factors;
  std::vector<size_t> with_height;
  for (size_t i = 0; i < fixes.times.size(); ++i) {
    if (!std::isfinite(fixes.vertical_sigmas[i])) continue;
    with_height.push_back(i);
    times.push_back(fixes.times[i]);
    sigmas.push_back(fixes.vertical_sigmas[i]);
  }
  const double common = sigmas.empty() ? 1.0 : Median(std::vector(sigmas));
  for (const double sigma : sigmas) white_factors.push_back(sigma * sigma / (common * common));
  Eigen::MatrixXd rows(with_height.size(), kAlignmentUnknowns + 1);
  for (size_t k = 0; k < with_height.size(); ++k) {
    const size_t i = with_height[k];
    const auto at = static_cast<Eigen::Index>(k);
    rows.row(at).head<kAlignmentUnknowns>() = fixes.rows[i].row(2) / common;
    rows(at, kAlignmentUnknowns) = fixes.residuals[i].z() / common;
  }
  Whiten(times, white_factors, kVerticalNoise, &rows);
  normal.information +=
      rows.leftCols<kAlignmentUnknowns>().transpose() * rows.leftCols<kAlignmentUnknowns>();
  normal.right += rows.leftCols<kAlignmentUnknowns>().transpose() * rows.col(kAlignmentUnknowns);

  // The vertical of the path, turned to the local frame, has no horizontal part.
  const Vector3d up = state.rotation * problem.up.up;
  const Matrix3d by_rotation = -Skew(up);
  for (int axis = 0; axis < 2; ++axis) {
    AlignmentRow row = AlignmentRow::Zero();
    row.segment<3>(1) = by_rotation.row(axis);
    normal.Add(row, -up[axis], problem.up.sigma);
  }
  if (problem.scale) {
    normal.Add(AlignmentRow::Unit(0), problem.scale->log_scale - std::log(state.scale),
               problem.scale->sigma);
  }
  AlignmentRow height = AlignmentRow::Zero();
  height[6] = 1;
  normal.Add(height, 0, kUnknownHeight);
  AlignmentRow clock = AlignmentRow::Zero();
  clock[kClockUnknown] = 1;
  const double sigma = problem.positions->clock_offset_sigma;
  if (std::isfinite(sigma)) {
    normal.Add(clock, problem.positions->clock_offset - state.clock, sigma > 0 ? sigma : 1.0);
  } else {
    normal.Add(clock, 0, kUnknownClock);
  }
  return normal;
}

void Apply(const AlignmentVector& change, AlignmentState* state) {
  state->scale *= std::exp(std::clamp(change[0], -0.5, 0.5));
  state->rotation = (ExpSo3(change.segment<3>(1)) * state->rotation).normalized();
  state->translation += change.segment<3>(4);
  state->clock += std::clamp(change[kClockUnknown], -kMaxClockStep, kMaxClockStep);
}

std::optional<AlignmentState> StartAt(AlignmentProblem* problem, double clock) {
  AlignmentState state{
      1, Eigen::Quaterniond::FromTwoVectors(problem->up.up, Vector3d::UnitZ()), {}, clock};
  state.translation.setZero();
  std::vector<Vector3d> places;
  Vector3d sum = Vector3d::Zero();
  Vector3d fix_sum = Vector3d::Zero();
  std::vector<Vector3d> fixes;
  for (const PositionFix& fix : problem->positions->fixes) {
    const auto at = Interpolate(problem->path, fix.timestamp + clock, kMaxPathGap);
    if (!at) continue;
    places.push_back(at->position);
    fixes.push_back(fix.position);
    sum += places.back();
    fix_sum += fix.position;
  }
  if (places.size() < kMinAlignmentFixes) return std::nullopt;
  problem->center = sum / static_cast<double>(places.size());
  state.translation = fix_sum / static_cast<double>(places.size());
  double dot = 0, cross = 0, variance = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const Vector3d p = state.rotation * (places[i] - problem->center);
    const Vector3d f = fixes[i] - state.translation;
    dot += p.x() * f.x() + p.y() * f.y();
    cross += p.x() * f.y() - p.y() * f.x();
    variance += p.head<2>().squaredNorm();
  }
  const double length = std::hypot(dot, cross);
  if (!(variance > 0 && length > 0)) return std::nullopt;
  state.scale = length / variance;
  state.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(cross, dot), Vector3d::UnitZ())) *
      state.rotation;
  return state;
}

}  // namespace orb360
