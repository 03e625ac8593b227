// The dense cloud of a hall of 1024 x 512 pixels a keyframe: comparing one keyframe with ten
// others, and the whole way from files to voxels.
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "slam/depth/dense_cloud.h"
#include "slam/io/depth_map_store.h"
#include "tests/slam/depth/range_room.h"

namespace orb360 {
namespace {

constexpr int kKeyframes = 24;
constexpr int kNeighbours = 10;

Rigid3 Camera(int i) { return TurnedCamera({-6.0 + 0.5 * i, 0.02 * i, 0.1}, 0.03 * i); }

/// Keyframes half a metre apart, of a hall of 40 x 24 x 6 metres.
std::vector<DenseDepth> RenderHall(int count) {
  const RangeRoom hall{{20.0, 12.0, 3.0}};
  std::vector<DenseDepth> depths;
  depths.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) depths.push_back(hall.Render({1024, 512}, Camera(i)));
  return depths;
}

void FindConsistentPointsOfKeyframe(benchmark::State& state) {
  const std::vector<DenseDepth> depths = RenderHall(kNeighbours + 1);
  std::vector<DepthView> views;
  for (int i = 0; i <= kNeighbours; ++i) {
    views.emplace_back(depths[static_cast<size_t>(i)], Camera(i),
                       GeometricConsistencyOptions().min_error);
  }
  std::vector<const DepthView*> others;
  for (int i = 0; i <= kNeighbours; ++i) {
    if (i != kNeighbours / 2) others.push_back(&views[static_cast<size_t>(i)]);
  }
  size_t points = 0;
  for (auto _ : state) {
    points = FindConsistentPoints(views[kNeighbours / 2], others, {}, {}).size();
  }
  state.counters["points"] = static_cast<double>(points);
}
BENCHMARK(FindConsistentPointsOfKeyframe)->Unit(benchmark::kMillisecond)->UseRealTime();

void FuseHall(benchmark::State& state) {
  const DepthMapStore store(std::filesystem::temp_directory_path() /
                            ("orb360_dense_cloud_benchmark." + std::to_string(getpid())));
  const std::vector<DenseDepth> depths = RenderHall(kKeyframes);
  std::vector<DenseView> views;
  for (int i = 0; i < kKeyframes; ++i) {
    store.Put(i, depths[static_cast<size_t>(i)]);
    views.push_back({i, 0, Camera(i), {}});
    for (int j = 0; j < kKeyframes; ++j) {
      if (j != i) views.back().neighbours.push_back(static_cast<size_t>(j));
    }
  }
  size_t voxels = 0;
  for (auto _ : state) {
    voxels = 0;
    FuseCloud(
        views, [&store](int frame) { return store.Get(frame); }, {},
        [&voxels](std::span<const Voxel> part) { voxels += part.size(); });
  }
  state.counters["voxel_parts"] = static_cast<double>(voxels);
  state.counters["ms_per_keyframe"] =
      benchmark::Counter(1e-3 * kKeyframes, benchmark::Counter::kIsIterationInvariantRate |
                                                benchmark::Counter::kInvert);
}
BENCHMARK(FuseHall)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace orb360
