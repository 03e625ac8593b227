// Pose refinement with 500 landmarks, and local bundle adjustment of 20 keyframes and 5,000
// landmarks, without and with ranges that are known roughly; ours beside Ceres on the problem of a
// usual window and on that of a whole map.
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/optimization/pose_refinement.h"
#include "tests/slam/geometry/random_geometry.h"
#include "slam/optimization/ceres/bundle_solver.h"
#include "tests/slam/pipeline/synthetic_scene.h"

namespace orb360 {
namespace {

void RefinePoseOf500(benchmark::State& state) {
  SyntheticScene scene(500);
  const Rigid3 truth{ExpSo3({0.1, 0.2, 0.3}), {0.5, 0.1, 0.0}};
  const auto features = scene.See(truth);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 500; ++i) {
    observations.push_back(
        {scene.points[i].position, features->bearings[i], features->keypoints[i].sigma});
  }
  const Rigid3 guess{ExpSo3({0.12, 0.2, 0.28}), {0.4, 0.12, 0.05}};
  for (auto _ : state) benchmark::DoNotOptimize(RefinePose(guess, observations));
}
BENCHMARK(RefinePoseOf500)->Unit(benchmark::kMillisecond);

void AdjustTwentyKeyframes(benchmark::State& state) {
  // Every landmark is seen by all: twice as many observations as in a usual map of this size.
  SyntheticScene scene(5000);
  const std::vector<Rigid3> poses = Walk(22, {-0.3, 0.05, 0.0});
  Map map = scene.MakeMap(poses, 5000);
  for (const KeyframeId id : map.KeyframeIds()) {
    if (state.range(0) != 0) map.keyframe(id).range_priors.assign(5000, {10.0F, 0.5F});
  }
  LocalBundleOptions options;
  options.max_keyframes = 20;
  for (auto _ : state) {
    state.PauseTiming();
    Map copy = map;
    state.ResumeTiming();
    AdjustLocally(21, options, {}, &copy);
  }
}
BENCHMARK(AdjustTwentyKeyframes)->ArgName("ranges")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

using Solver = SolverReport (*)(const BundleOptions&, BundleProblem*);

// 10 poses that move and 16 that do not, 2,300 points seen by five of them in a row.
void SolveWindow(benchmark::State& state, Solver solve) {
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
    for (int i = first; i < first + 5; ++i) {
      const Eigen::Vector3d seen = window.world_from_camera[i].Inverse() * point;
      window.observations.push_back({i, p, random.Noisy(seen.normalized(), 0.002), 0.002});
    }
  }
  for (auto _ : state) {
    state.PauseTiming();
    BundleProblem copy = window;
    state.ResumeTiming();
    solve({.max_iterations = 4, .function_tolerance = 0}, &copy);
  }
}

// Three times round a block, 300 poses, 24,000 points seen by six of them in a row, and a few
// clouds seen by all.
void SolveMap(benchmark::State& state, Solver solve) {
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
    // A fifth of them is seen in the next round as well.
    const int again = p % 5 == 0 && first + kRound + 3 < kPoses ? 3 : 0;
    for (int k = 0; k < 6; ++k) {
      const int i = k < 6 - again ? first + k : first + kRound + k - 3;
      const Eigen::Vector3d seen = map.world_from_camera[i].Inverse() * point;
      map.observations.push_back({i, p, random.Noisy(seen.normalized(), 0.002), 0.002});
    }
  }
  for (int c = 0; c < 12; ++c) {
    const auto p = static_cast<int>(map.points.size());
    map.points.push_back(random.Point(1e4, 2e4));
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::Vector3d seen = map.world_from_camera[i].Inverse() * map.points[p];
      map.observations.push_back({i, p, random.Noisy(seen.normalized(), 0.002), 0.002});
    }
  }
  for (auto _ : state) {
    state.PauseTiming();
    BundleProblem copy = map;
    state.ResumeTiming();
    solve({.max_iterations = 4, .function_tolerance = 0}, &copy);
  }
}
BENCHMARK_CAPTURE(SolveMap, ours, SolveBundle)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(SolveMap, ceres, SolveBundleCeres)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(SolveWindow, ours, SolveBundle)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(SolveWindow, ceres, SolveBundleCeres)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace orb360
