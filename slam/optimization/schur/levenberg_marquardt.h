#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "slam/optimization/solver_report.h"

namespace orb360 {

/// The diagonal that Levenberg and Marquardt's method adds to a part of the Hessian's `diagonal`
/// for a trust region of `radius`, bounded below as in Ceres (min_lm_diagonal).
template <typename Vector>
Vector LevenbergMarquardtDamping(const Vector& diagonal, double radius) {
  constexpr double kMinDiagonal = 1e-6;
  return diagonal.cwiseMax(kMinDiagonal) / radius;
}

/// The trust region's radius, by the rule of Nielsen, Damping Parameter in Marquardt's Method,
/// 1999, with the constants of Ceres (LevenbergMarquardtStrategy).
class TrustRegion {
 public:
  /// The least gain ratio, actual by predicted decrease of the cost, with which a step is taken.
  static constexpr double kMinGainRatio = 1e-3;

  double radius() const { return radius_; }

  void AcceptStep(double gain_ratio) {
    radius_ =
        std::min(kMaxRadius, radius_ / std::max(1.0 / 3.0, 1 - std::pow(2 * gain_ratio - 1, 3)));
    decrease_factor_ = 2;
  }
  /// False where the region has become too small to go on.
  bool RejectStep() {
    radius_ /= decrease_factor_;
    decrease_factor_ *= 2;
    return radius_ >= kMinRadius;
  }

 private:
  static constexpr double kMaxRadius = 1e16;
  static constexpr double kMinRadius = 1e-32;

  double radius_ = 1e4;
  double decrease_factor_ = 2;
};

struct LevenbergMarquardtOptions {
  int max_iterations;
  /// The solver stops when an iteration changes the cost by less than this fraction ...
  double function_tolerance;
  /// ... when no component of the gradient is larger ...
  double gradient_tolerance = 0;
  /// ... or when the norm of the step is less than this fraction of the state's.
  double parameter_tolerance = 0;
};

/// Minimizes a cost by Levenberg and Marquardt's method, damped as Ceres does it. A Problem has a
/// state and a candidate for the next one:
///   double Cost() const             cost of the state; infinite where it is not defined
///   void Linearize()                forms the normal equations at the state
///   std::optional<double> ComputeCandidate(double radius)
///                                   solves the damped equations, steps to the candidate and
///                                   returns the decrease of the cost that the linear model
///                                   predicts; none where the equations are not positive definite
///                                   to rounding or where the model predicts no decrease
///   double CandidateCost() const    cost of the candidate
///   void AcceptCandidate()          makes the candidate the state
/// and, where their tolerances are positive,
///   double GradientMaxNorm() const  largest component of the gradient at the state
///   std::pair<double, double> StepAndStateNorms() const
///                                   norm of the step to the candidate, and of the state
/// The state is unchanged where the report is not usable.
template <typename Problem>
SolverReport MinimizeLevenbergMarquardt(const LevenbergMarquardtOptions& options,
                                        Problem* problem) {
  double cost = problem->Cost();
  SolverReport report{
      .initial_cost = cost, .final_cost = cost, .iterations = 0, .usable = std::isfinite(cost)};
  if (!report.usable) return report;
  TrustRegion region;
  bool is_linearized = false;
  bool has_solved = false;
  while (report.iterations < options.max_iterations && cost > 0) {
    if (!is_linearized) {
      problem->Linearize();
      if constexpr (requires { problem->GradientMaxNorm(); }) {
        if (problem->GradientMaxNorm() <= options.gradient_tolerance) break;
      }
    }
    is_linearized = true;
    ++report.iterations;
    double gain_ratio = 0;
    bool has_converged = false;
    if (const std::optional<double> predicted = problem->ComputeCandidate(region.radius())) {
      has_solved = true;
      const double new_cost = problem->CandidateCost();
      has_converged = std::abs(cost - new_cost) <= options.function_tolerance * cost;
      if constexpr (requires { problem->StepAndStateNorms(); }) {
        const auto [step, state] = problem->StepAndStateNorms();
        const double tolerance = options.parameter_tolerance;
        has_converged |= step <= tolerance * (state + tolerance);
      }
      gain_ratio = (cost - new_cost) / *predicted;
      if (gain_ratio > TrustRegion::kMinGainRatio) {
        problem->AcceptCandidate();
        cost = new_cost;
        is_linearized = false;
      }
    }
    if (has_converged) break;
    if (!is_linearized) {
      region.AcceptStep(gain_ratio);
    } else if (!region.RejectStep()) {
      break;
    }
  }
  report.final_cost = cost;
  report.usable = has_solved || report.iterations == 0;
  return report;
}

}  // namespace orb360
