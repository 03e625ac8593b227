// Whole tracking and mapping of a hall rendered beforehand: time per frame at 640 x 320 and
// 2048 x 1024, mapping beside it as in a run.
#include <benchmark/benchmark.h>

#include "tests/slam/geometry/box_room.h"
#include <orb360/slam/io/frame_source.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

namespace orb360 {
namespace {

constexpr int kFrames = 60;

void TrackHall(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const EquirectangularCamera camera(width, width / 2);
  const BoxRoom room({8.0, 4.0, 2.0}, 1);
  std::vector<Frame> frames;
  for (int i = 0; i < kFrames; ++i) {
    const Rigid3 pose{ExpSo3({0.0, 0.0, 0.005 * i}), {5.0 - 0.05 * i, 0.01 * i, 0.0}};
    frames.push_back({i, i / 25.0, room.Render(camera, pose)});
  }
  size_t tracked = 0;
  for (auto _ : state) {
    System system(camera, Options(), cv::Mat());
    for (const Frame& frame : frames) system.Process(frame);
    tracked = system.Finish().frames.size();
  }
  state.counters["tracked"] = static_cast<double>(tracked);
  state.counters["ms_per_frame"] = benchmark::Counter(
      1e-3 * kFrames, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(TrackHall)->Arg(640)->Arg(2048)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace orb360
