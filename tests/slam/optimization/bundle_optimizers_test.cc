// What holds for SolveBundle by either optimizer, and by the own one beside Ceres.
#include <cmath>

#include <gtest/gtest.h>

#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/ceres/bundle_solver.h"
#include "tests/slam/optimization/noisy_walk.h"

namespace orb360 {
namespace {

/// A walk with poses and points as good as unknown.
BundleProblem FarStart(int seed) {
  BundleProblem problem = NoisyWalk(seed);
  RandomGeometry random(seed);
  for (size_t i = 0; i < problem.world_from_camera.size(); ++i) {
    Rigid3& pose = problem.world_from_camera[i];
    if (!problem.pose_fixed[i]) pose = pose * Rigid3{random.Rotation(1.0), random.Point(0.0, 2.0)};
  }
  for (Eigen::Vector3d& point : problem.points) point += random.Point(0.0, 3.0);
  return problem;
}

class BundleSolvers : public testing::TestWithParam<BundleLoss> {};

// Ceres is the independent truth here.
TEST_P(BundleSolvers, ComeToTheSameMinimum) {
  for (int seed = 1; seed <= 3; ++seed) {
    BundleProblem own = NoisyWalk(seed);
    BundleProblem other = own;
    const BundleOptions options{
        .max_iterations = 200, .loss = GetParam(), .function_tolerance = 1e-15};
    const SolverReport ours = SolveBundle(options, &own);
    const SolverReport by_ceres = SolveBundleCeres(options, &other);
    ASSERT_TRUE(ours.usable && by_ceres.usable);
    EXPECT_NEAR(ours.initial_cost, by_ceres.initial_cost, 1e-9 * by_ceres.initial_cost);
    EXPECT_LT(ours.final_cost, 0.9 * ours.initial_cost);
    EXPECT_NEAR(ours.final_cost, by_ceres.final_cost, 1e-8 * by_ceres.final_cost);
    for (size_t i = 0; i < own.world_from_camera.size(); ++i) {
      const Rigid3 difference = own.world_from_camera[i].Inverse() * other.world_from_camera[i];
      EXPECT_LT(difference.translation.norm(), 1e-5) << i;
      EXPECT_LT(LogSo3(difference.rotation).norm(), 1e-5) << i;
    }
  }
}

// Points that more poses see than ReducedCameraStructure::kMaxPoses are not eliminated.
TEST(SolveBundle, ComesToTheMinimumOfCeresWhereAllSeeTheSamePoints) {
  BundleProblem own = NoisyWalk(7);
  RandomGeometry random(7);
  for (size_t i = own.world_from_camera.size(); i < 90; ++i) {
    const Rigid3 pose{random.Rotation(0.3), random.Point(0.0, 1.0)};
    for (int p = 0; p < 200; p += 10) {
      const Eigen::Vector3d seen = pose.Inverse() * own.points[p];
      own.observations.push_back(
          {static_cast<int>(i), p, random.Noisy(seen.normalized(), 0.002), 0.002});
    }
    own.world_from_camera.push_back(pose * Rigid3{random.Rotation(0.01), random.Point(0.0, 0.03)});
    own.pose_fixed.push_back(0);
  }
  BundleProblem other = own;
  const BundleOptions options{.max_iterations = 100, .function_tolerance = 1e-12};
  const SolverReport ours = SolveBundle(options, &own);
  const SolverReport by_ceres = SolveBundleCeres(options, &other);
  ASSERT_TRUE(ours.usable && by_ceres.usable);
  EXPECT_LT(ours.final_cost, 0.9 * ours.initial_cost);
  EXPECT_NEAR(ours.final_cost, by_ceres.final_cost, 1e-8 * by_ceres.final_cost);
}

// Where there are fewer points than poses, both solvers eliminate the poses first.
TEST(SolveBundle, ComesToTheMinimumOfCeresWithFewerPointsThanPoses) {
  RandomGeometry random(8);
  BundleProblem own;
  for (int i = 0; i < 40; ++i) {
    own.world_from_camera.push_back({random.Rotation(0.3), {0.1 * i, 0.02 * i, 0.0}});
    own.pose_fixed.push_back(i < 2);
  }
  for (int p = 0; p < 15; ++p) {
    const Eigen::Vector3d point = random.Point(2.0, 12.0);
    own.points.push_back(point + random.Point(0.0, 0.05));
    for (int i = 0; i < 40; ++i) {
      if ((i + p) % 4 == 0) continue;
      const Eigen::Vector3d seen = own.world_from_camera[i].Inverse() * point;
      own.observations.push_back({.pose = i,
                                  .point = p,
                                  .bearing = random.Noisy(seen.normalized(), 0.002),
                                  .sigma = 0.002});
    }
  }
  BundleProblem other = own;
  const BundleOptions options{.max_iterations = 100, .function_tolerance = 1e-12};
  const SolverReport ours = SolveBundle(options, &own);
  const SolverReport by_ceres = SolveBundleCeres(options, &other);
  ASSERT_TRUE(ours.usable && by_ceres.usable);
  EXPECT_LT(ours.final_cost, 0.9 * ours.initial_cost);
  EXPECT_NEAR(ours.final_cost, by_ceres.final_cost, 1e-8 * by_ceres.final_cost);
}

// With few iterations, as in local bundle adjustment.
TEST_P(BundleSolvers, ComeEquallyFarInFewSteps) {
  BundleProblem own = NoisyWalk(4);
  BundleProblem other = own;
  const BundleOptions options{.max_iterations = 4, .loss = GetParam()};
  const SolverReport ours = SolveBundle(options, &own);
  const SolverReport by_ceres = SolveBundleCeres(options, &other);
  ASSERT_TRUE(ours.usable);
  EXPECT_LE(ours.iterations, 4);
  EXPECT_LT(ours.final_cost, 0.9 * ours.initial_cost);
  EXPECT_NEAR(ours.final_cost, by_ceres.final_cost, 0.02 * by_ceres.final_cost);
}

INSTANTIATE_TEST_SUITE_P(Losses, BundleSolvers,
                         testing::Values(BundleLoss::kHuber, BundleLoss::kArctan));

class EitherOptimizer : public testing::TestWithParam<Optimizer> {
 protected:
  BundleOptions options() const { return {.optimizer = GetParam()}; }
};

INSTANTIATE_TEST_SUITE_P(Optimizers, EitherOptimizer,
                         testing::Values(Optimizer::kSchur, Optimizer::kCeres));

bool IsSame(const Rigid3& a, const Rigid3& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

TEST_P(EitherOptimizer, MovesThePosesThatAreNotFixedAndNoOther) {
  const BundleProblem before = NoisyWalk(5);
  BundleProblem problem = before;
  ASSERT_TRUE(SolveBundle(options(), &problem).usable);
  for (size_t i = 0; i < before.world_from_camera.size(); ++i) {
    EXPECT_EQ(IsSame(problem.world_from_camera[i], before.world_from_camera[i]),
              before.pose_fixed[i] != 0)
        << i;
  }
}

TEST_P(EitherOptimizer, GivesTheSameBitsTwice) {
  BundleProblem problem = NoisyWalk(5);
  BundleProblem again = problem;
  const SolverReport report = SolveBundle(options(), &problem);
  EXPECT_EQ(SolveBundle(options(), &again).final_cost, report.final_cost);
  EXPECT_EQ(problem.points, again.points);
  for (size_t i = 0; i < problem.world_from_camera.size(); ++i) {
    EXPECT_TRUE(IsSame(problem.world_from_camera[i], again.world_from_camera[i])) << i;
  }
}

TEST_P(BundleSolvers, ComeAsFarFarAwayFromTheOrigin) {
  BundleProblem near = NoisyWalk(4);
  BundleProblem far = near;
  const Eigen::Vector3d away(2000, -500, 100);
  for (Rigid3& pose : far.world_from_camera) pose.translation += away;
  for (Eigen::Vector3d& point : far.points) point += away;
  for (const auto solve : {SolveBundle, SolveBundleCeres}) {
    BundleProblem near_copy = near;
    BundleProblem far_copy = far;
    const BundleOptions options{.max_iterations = 3, .loss = GetParam()};
    const SolverReport near_report = solve(options, &near_copy);
    const SolverReport far_report = solve(options, &far_copy);
    EXPECT_LT(near_report.final_cost, 0.95 * near_report.initial_cost);
    EXPECT_NEAR(far_report.final_cost, near_report.final_cost, 1e-6 * near_report.final_cost);
  }
}

TEST_P(EitherOptimizer, LeavesTheProblemAsItIsWhereAResidualHasNoValue) {
  BundleProblem problem = NoisyWalk(6);
  problem.points[0] = problem.world_from_camera[0].translation;  // sees it at range zero
  const BundleProblem before = problem;
  EXPECT_FALSE(SolveBundle(options(), &problem).usable);
  EXPECT_EQ(problem.points, before.points);
  for (size_t i = 0; i < before.world_from_camera.size(); ++i) {
    EXPECT_TRUE(IsSame(problem.world_from_camera[i], before.world_from_camera[i])) << i;
  }
}

// A point that all poses see in nearly the same direction has next to no range: the step must not
// throw it behind the cameras, or anything else to infinity.
TEST(SolveBundle, BearsPointsWithoutParallax) {
  BundleProblem problem = NoisyWalk(7);
  problem.ranges.clear();
  const size_t first_far = problem.observations.size();
  RandomGeometry random(8);
  for (int p = 0; p < 50; ++p) {
    const Eigen::Vector3d far = 1e6 * random.Bearing();
    const int point = static_cast<int>(problem.points.size());
    problem.points.push_back(1e-4 * far);
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d seen = problem.world_from_camera[i].Inverse() * far;
      problem.observations.push_back({i, point, seen.normalized(), 0.001});
    }
  }
  const SolverReport report = SolveBundle({.max_iterations = 50}, &problem);
  ASSERT_TRUE(report.usable);
  EXPECT_LT(report.final_cost, 0.9 * report.initial_cost);
  for (size_t o = first_far; o < problem.observations.size(); ++o) {
    EXPECT_LT(SquaredResidual(problem, problem.observations[o]), 100.0);
  }
}

// The way down is not smooth from here: steps are refused on it.
TEST(SolveBundle, ComesDownFromAFarStart) {
  BundleProblem problem = FarStart(9);
  BundleProblem other = problem;
  const BundleOptions options{.max_iterations = 300, .function_tolerance = 1e-12};
  const SolverReport report = SolveBundle(options, &problem);
  const SolverReport by_ceres = SolveBundleCeres(options, &other);
  ASSERT_TRUE(report.usable && by_ceres.usable);
  EXPECT_LT(report.final_cost, 0.5 * report.initial_cost);
  EXPECT_LT(report.final_cost, 1.2 * by_ceres.final_cost);
}

TEST(SolveBundle, RefusesAStepThatLeadsUpAndFindsOneThatLeadsDown) {
  int refused = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    BundleProblem problem = FarStart(seed);
    BundleOptions options{.max_iterations = 1, .loss = BundleLoss::kArctan};
    for (int step = 1; step <= 3; ++step) {
      const SolverReport report = SolveBundle(options, &problem);
      EXPECT_LE(report.final_cost, report.initial_cost) << seed;
      if (report.final_cost < report.initial_cost) continue;
      ++refused;
      BundleProblem copy = problem;
      options.max_iterations = 20;
      EXPECT_LT(SolveBundle(options, &copy).final_cost, report.initial_cost) << seed;
      options.max_iterations = 1;
    }
  }
  EXPECT_GT(refused, 0);  // or this tests nothing
}

TEST(SolveBundle, StopsWhereNothingIsToBeGained) {
  BundleProblem problem = NoisyWalk(12);
  SolveBundle({.max_iterations = 200, .function_tolerance = 1e-12}, &problem);
  const SolverReport again =
      SolveBundle({.max_iterations = 200, .function_tolerance = 1e-6}, &problem);
  EXPECT_EQ(again.iterations, 1);
}

TEST_P(EitherOptimizer, TakesProblemsWithoutFreePosesOrWithoutObservations) {
  BundleProblem all_fixed = NoisyWalk(10);
  all_fixed.pose_fixed.assign(all_fixed.pose_fixed.size(), 1);
  const SolverReport report = SolveBundle(options(), &all_fixed);
  EXPECT_TRUE(report.usable);
  EXPECT_LT(report.final_cost, report.initial_cost);  // points move

  BundleProblem empty;
  empty.world_from_camera = {Rigid3()};
  empty.pose_fixed = {0};
  EXPECT_TRUE(SolveBundle(options(), &empty).usable);

  BundleProblem blind = NoisyWalk(11);
  blind.world_from_camera.push_back({Eigen::Quaterniond::Identity(), {1, 2, 3}});
  blind.pose_fixed.push_back(0);
  EXPECT_TRUE(SolveBundle(options(), &blind).usable);
  EXPECT_EQ(blind.world_from_camera.back().translation, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace orb360
