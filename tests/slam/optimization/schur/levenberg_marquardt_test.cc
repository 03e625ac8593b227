#include "slam/optimization/schur/levenberg_marquardt.h"

#include <limits>
#include <utility>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(TrustRegion, FollowsNielsensRule) {
  TrustRegion region;
  EXPECT_EQ(region.radius(), 1e4);
  region.AcceptStep(1.0);  // as predicted: three times as large
  EXPECT_NEAR(region.radius(), 3e4, 1e-8);
  region.AcceptStep(0.5);  // half as much: as large as before
  EXPECT_NEAR(region.radius(), 3e4, 1e-8);
  region.AcceptStep(0.25);
  EXPECT_NEAR(region.radius(), 3e4 / 1.125, 1e-8);
  EXPECT_TRUE(region.RejectStep());
  EXPECT_TRUE(region.RejectStep());
  EXPECT_NEAR(region.radius(), 3e4 / 1.125 / 8, 1e-8);
  region.AcceptStep(0.5);
  EXPECT_TRUE(region.RejectStep());  // begins with a half again
  EXPECT_NEAR(region.radius(), 3e4 / 1.125 / 16, 1e-8);
  int rejected = 0;
  while (region.RejectStep()) ++rejected;
  EXPECT_LT(rejected, 20);
}

TEST(LevenbergMarquardtDamping, IsTheDiagonalOverTheRadiusButNotZero) {
  const Eigen::Vector3d damping = LevenbergMarquardtDamping(Eigen::Vector3d(4, 0, 1e-9), 100.0);
  EXPECT_TRUE(damping.isApprox(Eigen::Vector3d(0.04, 1e-8, 1e-8)));
}

/// Half of the square of the residual atan(x - 2), on whose flanks Gauss-Newton steps overshoot.
struct AtanProblem {
  double x;
  double candidate = 0;
  double residual = 0;
  double slope = 0;
  int linearized = 0;

  static double CostAt(double x) { return 0.5 * std::pow(std::atan(x - 2), 2); }
  double Cost() const { return CostAt(x); }
  void Linearize() {
    residual = std::atan(x - 2);
    slope = 1 / (1 + (x - 2) * (x - 2));
    ++linearized;
  }
  std::optional<double> ComputeCandidate(double radius) {
    const double hessian = slope * slope;
    const double damping = std::max(hessian, 1e-6) / radius;
    const double step = -slope * residual / (hessian + damping);
    candidate = x + step;
    const double predicted = 0.5 * (damping * step - slope * residual) * step;
    if (!(predicted > 0)) return std::nullopt;
    return predicted;
  }
  double CandidateCost() const { return CostAt(candidate); }
  void AcceptCandidate() { std::swap(x, candidate); }
};

TEST(MinimizeLevenbergMarquardt, FindsTheMinimumWhereGaussNewtonDiverges) {
  AtanProblem problem{.x = 6};
  const SolverReport report =
      MinimizeLevenbergMarquardt({.max_iterations = 100, .function_tolerance = 1e-15}, &problem);
  EXPECT_TRUE(report.usable);
  EXPECT_NEAR(problem.x, 2, 1e-6);
  EXPECT_EQ(report.initial_cost, AtanProblem::CostAt(6));
  EXPECT_EQ(report.final_cost, problem.Cost());
  EXPECT_LT(problem.linearized, report.iterations);  // a refused step needs no new equations
}

TEST(MinimizeLevenbergMarquardt, StopsAtItsLimitOfIterationsWithTheLeastCostSoFar) {
  AtanProblem problem{.x = 3};
  const SolverReport report =
      MinimizeLevenbergMarquardt({.max_iterations = 2, .function_tolerance = 0}, &problem);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_LT(report.final_cost, report.initial_cost);
  EXPECT_EQ(report.final_cost, problem.Cost());
}

TEST(MinimizeLevenbergMarquardt, IsNotUsableWhereTheCostIsNotDefined) {
  AtanProblem problem{.x = std::numeric_limits<double>::quiet_NaN()};
  EXPECT_FALSE(
      MinimizeLevenbergMarquardt({.max_iterations = 5, .function_tolerance = 0}, &problem).usable);
}

}  // namespace
}  // namespace orb360
