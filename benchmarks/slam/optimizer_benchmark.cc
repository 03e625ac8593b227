// The own solver beside Ceres (EIGEN_SPARSE) on the same problems, on one thread and with the same
// stopping rule. Each case solves a problem by both in turn and reports the medians of their
// processor times, the median ratio of the pairs (own / Ceres), and their final costs:
//   build/slam_benchmarks --benchmark_filter=Optimizers
// It is run from the root of the checkout, since the problems of libmv are read from
// ../shared/data/libmv_ba.
#include <cmath>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "nn/base/statistics.h"
#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/pose_graph.h"
#include "tests/slam/geometry/random_geometry.h"
#include "tests/slam/optimization/circle_graph.h"
#include "tests/slam/optimization/libmv_problem.h"

namespace orb360 {
namespace {

double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Calls solve(optimizer, copy of `problem`), which returns a SolverReport, by turns.
template <typename Problem, typename Solve>
void Compare(benchmark::State& state, const Problem& problem, const Solve& solve) {
  std::vector<double> own_seconds;
  std::vector<double> ceres_seconds;
  std::vector<double> ratios;
  SolverReport own;
  SolverReport by_ceres;
  const auto run = [&](Optimizer optimizer, SolverReport* report, std::vector<double>* seconds) {
    Problem copy = problem;
    const double begin = ThreadSeconds();
    *report = solve(optimizer, &copy);
    seconds->push_back(ThreadSeconds() - begin);
  };
  for (auto _ : state) {
    run(Optimizer::kSchur, &own, &own_seconds);
    run(Optimizer::kCeres, &by_ceres, &ceres_seconds);
    ratios.push_back(own_seconds.back() / ceres_seconds.back());
  }
  state.counters["own_ms"] = 1e3 * Median(own_seconds);
  state.counters["ceres_ms"] = 1e3 * Median(ceres_seconds);
  state.counters["ratio"] = Median(ratios);
  state.counters["own_iterations"] = own.iterations;
  state.counters["ceres_iterations"] = by_ceres.iterations;
  state.counters["own_cost"] = own.final_cost;
  state.counters["ceres_cost"] = by_ceres.final_cost;
  state.counters["difference"] =
      std::abs(own.final_cost - by_ceres.final_cost) / by_ceres.final_cost;
}

void CompareBundle(benchmark::State& state, const BundleProblem& problem,
                   const BundleOptions& options) {
  Compare(state, problem, [&](Optimizer optimizer, BundleProblem* copy) {
    BundleOptions chosen = options;
    chosen.optimizer = optimizer;
    return SolveBundle(chosen, copy);
  });
}

constexpr BundleOptions kToConvergence{.max_iterations = 200, .function_tolerance = 1e-9};

void Observe(int pose, int point, const Eigen::Vector3d& position, RandomGeometry* random,
             BundleProblem* problem) {
  const Eigen::Vector3d seen = problem->world_from_camera[pose].Inverse() * position;
  problem->observations.push_back({.pose = pose,
                                   .point = point,
                                   .bearing = random->Noisy(seen.normalized(), 0.002),
                                   .sigma = 0.002});
}

// The window of local bundle adjustment: 10 poses that move and 16 that do not, 2,300 points each
// seen by five of them in a row.
BundleProblem MakeWindow() {
  RandomGeometry random(3);
  BundleProblem window;
  for (int i = 0; i < 26; ++i) {
    window.world_from_camera.push_back({random.Rotation(0.1), {0.5 * i, 0.0, 0.0}});
    window.pose_fixed.push_back(i < 8 || i >= 18);
  }
  for (int p = 0; p < 2300; ++p) {
    const int first = p % 22;
    const Eigen::Vector3d point =
        window.world_from_camera[first + 2].translation + random.Point(3.0, 20.0);
    window.points.push_back(point + random.Point(0.0, 0.1));
    for (int i = first; i < first + 5; ++i) Observe(i, p, point, &random, &window);
  }
  return window;
}

// A whole map: three times round a block, 300 poses, 24,000 points each seen by six of them, a
// fifth of the points in two rounds, and `num_clouds` points seen by all.
BundleProblem MakeMap(int num_clouds) {
  RandomGeometry random(4);
  constexpr int kPoses = 300;
  constexpr int kRound = 100;
  BundleProblem map;
  for (int i = 0; i < kPoses; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRound;
    map.world_from_camera.push_back(
        {random.Rotation(0.1), {50 * std::cos(angle), 50 * std::sin(angle), 0}});
    map.pose_fixed.push_back(i == 0);
  }
  for (int p = 0; p < 80 * kPoses; ++p) {
    const int first = p % (kPoses - 5);
    const Eigen::Vector3d point =
        map.world_from_camera[first].translation + random.Point(3.0, 20.0);
    map.points.push_back(point + random.Point(0.0, 0.1));
    const int again = p % 5 == 0 && first + kRound + 3 < kPoses ? 3 : 0;
    for (int k = 0; k < 6; ++k) {
      Observe(k < 6 - again ? first + k : first + kRound + k - 3, p, point, &random, &map);
    }
  }
  for (int c = 0; c < num_clouds; ++c) {
    const auto p = static_cast<int>(map.points.size());
    map.points.push_back(random.Point(1e4, 2e4));
    for (int i = 0; i < kPoses; ++i) Observe(i, p, map.points[p], &random, &map);
  }
  return map;
}

// As mapping runs it for each keyframe.
void OptimizersLocalFourIterations(benchmark::State& state) {
  CompareBundle(state, MakeWindow(), {.max_iterations = 4});
}
BENCHMARK(OptimizersLocalFourIterations)->Unit(benchmark::kMillisecond)->Iterations(15);

void OptimizersLocal(benchmark::State& state) {
  CompareBundle(state, MakeWindow(), kToConvergence);
}
BENCHMARK(OptimizersLocal)->Unit(benchmark::kMillisecond)->Iterations(15);

// A round of the adjustment of a whole map.
void OptimizersGlobalFiveIterations(benchmark::State& state) {
  CompareBundle(state, MakeMap(static_cast<int>(state.range(0))),
                {.max_iterations = 5, .loss = BundleLoss::kArctan});
}
BENCHMARK(OptimizersGlobalFiveIterations)
    ->ArgName("clouds")
    ->Arg(0)
    ->Arg(12)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3);

void OptimizersGlobal(benchmark::State& state) {
  CompareBundle(state, MakeMap(12), kToConvergence);
}
BENCHMARK(OptimizersGlobal)->Unit(benchmark::kMillisecond)->Iterations(1);

void OptimizersLibmv(benchmark::State& state) {
  const std::filesystem::path file =
      std::filesystem::path("../shared/data/libmv_ba") / kLibmvProblems[state.range(0) - 1];
  if (!std::filesystem::exists(file)) {
    state.SkipWithError(("there is no " + file.string()).c_str());
    return;
  }
  CompareBundle(state, ReadLibmvProblem(file), kToConvergence);
}
BENCHMARK(OptimizersLibmv)
    ->ArgName("problem")
    ->DenseRange(1, 3)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

// Laps round a circle with drift, each node linked to four before it and every seventh to the lap
// before; solved by the stopping rule of loop closing.
void OptimizersPoseGraph(benchmark::State& state) {
  const PoseGraph graph = Laps(1, 3, static_cast<int>(state.range(0)) / 3, 1e5);
  Compare(state, graph, [](Optimizer optimizer, PoseGraph* copy) {
    return SolvePoseGraph({.optimizer = optimizer}, copy);
  });
}
BENCHMARK(OptimizersPoseGraph)
    ->ArgName("nodes")
    ->Arg(60)
    ->Arg(300)
    ->Arg(1500)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

}  // namespace
}  // namespace orb360
