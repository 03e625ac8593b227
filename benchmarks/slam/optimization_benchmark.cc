// Pose refinement with 500 landmarks, and local bundle adjustment of 20 keyframes and 5,000
// landmarks, without and with ranges that are known roughly. optimizer_benchmark.cc compares the
// solvers.
#include <benchmark/benchmark.h>

#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/optimization/pose_refinement.h"
#include "tests/slam/geometry/random_geometry.h"
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

}  // namespace
}  // namespace orb360
