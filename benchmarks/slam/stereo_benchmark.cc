// The stages of spherical stereo between two views of a hall of 1024 x 512 pixels on one thread,
// each beside two floors: the time in which its inputs and outputs can be copied, and the time in
// which its byte operations can be done, both as measured on this machine.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "slam/stereo/census.h"
#include "slam/stereo/disparity_refinement.h"
#include "slam/stereo/disparity_search.h"
#include "slam/stereo/rectified_sphere.h"
#include "slam/stereo/semi_global_matching.h"
#include "slam/stereo/speckles.h"
#include "slam/stereo/spherical_stereo.h"
#include "tests/slam/geometry/box_room.h"

namespace orb360 {
namespace {

constexpr int kWidth = 512;  // Of the rectified sphere.

using Clock = std::chrono::steady_clock;

// The shortest of a few times of `work`, seconds.
template <typename Work>
double Shortest(const Work& work) {
  double shortest = 1e9;
  for (int i = 0; i < 20; ++i) {
    const Clock::time_point start = Clock::now();
    work();
    shortest = std::min(shortest, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return shortest;
}

// Bytes read and written by copying a megabyte, a second.
double BytesPerSecond() {
  static const double result = [] {
    std::vector<char> from(size_t{1} << 20, 1);
    std::vector<char> to(from.size());
    constexpr int kTimes = 50;
    const double seconds = Shortest([&] {
      for (int i = 0; i < kTimes; ++i) {
        from[static_cast<size_t>(i)] = static_cast<char>(i);
        std::memcpy(to.data(), from.data(), from.size());
        benchmark::DoNotOptimize(to.data());
      }
    });
    return 2.0 * kTimes * static_cast<double>(from.size()) / seconds;
  }();
  return result;
}

// Additions and minima of bytes in the first-level cache, a second.
double ByteOperationsPerSecond() {
  static const double result = [] {
    alignas(64) std::array<std::uint8_t, 4096> a{};
    alignas(64) std::array<std::uint8_t, 4096> b{};
    constexpr int kTimes = 20000;
    const double seconds = Shortest([&] {
      for (int t = 0; t < kTimes; ++t) {
        for (size_t i = 0; i < a.size(); ++i) {
          const auto sum = static_cast<std::uint8_t>(a[i] + b[i]);
          a[i] = std::min(sum, static_cast<std::uint8_t>(b[i] + 3));
        }
        benchmark::DoNotOptimize(a.data());
      }
    });
    return 3.0 * kTimes * static_cast<double>(a.size()) / seconds;
  }();
  return result;
}

struct Views {
  StereoView reference;
  StereoView source;
  cv::Mat first;   // Rectified.
  cv::Mat second;  // Rectified.
};

const Views& Hall() {
  static const Views views = [] {
    const BoxRoom hall({8.0, 5.0, 3.0}, 7);
    const EquirectangularCamera camera(1024, 512);
    const auto look = [&](double place) {
      const Rigid3 pose{Eigen::Quaterniond::Identity(), {place, 0.1 * place, 0.05 * place}};
      cv::Mat gray;
      cv::cvtColor(hall.Render(camera, pose), gray, cv::COLOR_BGR2GRAY);
      return StereoView{gray, pose};
    };
    Views made{look(0.0), look(0.8), {}, {}};
    const Eigen::Matrix3d axes = BaselineAxes(made.source.world_from_camera.translation);
    made.first = RectifySphere(made.reference.gray, axes, kWidth);
    made.second = RectifySphere(made.source.gray, axes, kWidth);
    return made;
  }();
  return views;
}

// States the floors of a stage.
void StateFloors(double bytes, double operations, benchmark::State* state) {
  const double floor_ms =
      1e3 * std::max(bytes / BytesPerSecond(), operations / ByteOperationsPerSecond());
  state->counters["copy_ms"] = 1e3 * bytes / BytesPerSecond();
  state->counters["operations_ms"] = 1e3 * operations / ByteOperationsPerSecond();
  state->counters["floor_ms"] = floor_ms;
}

constexpr double kPixels = 2.0 * kWidth * kWidth;

void Rectify(benchmark::State& state) {
  const Eigen::Matrix3d axes = BaselineAxes(Hall().source.world_from_camera.translation);
  for (auto _ : state) benchmark::DoNotOptimize(RectifySphere(Hall().source.gray, axes, kWidth));
  // An interpolation is three weighted sums of two values.
  StateFloors(2 * kPixels, 9 * kPixels, &state);
}

// At half the width, where the finest search is.
void Search(benchmark::State& state) {
  cv::Mat first;
  cv::Mat second;
  cv::resize(Hall().first, first, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::resize(Hall().second, second, {}, 0.5, 0.5, cv::INTER_AREA);
  const cv::Mat inside = cv::Mat::zeros(first.size(), CV_8U);
  const CensusImage census1 = TransformCensus(first, inside);
  const CensusImage census2 = TransformCensus(second, inside);
  for (auto _ : state) {
    benchmark::DoNotOptimize(SearchDisparities(census1, census2, DisparityRange::kAround, {}));
  }
  // 16 hypotheses: 3 bytes are compared and their bits counted (9 operations), each of 4 paths
  // takes 3 minima, 3 sums and a difference, and their sum is compared twice.
  constexpr double kHypotheses = 16;
  StateFloors(kPixels / 4 * (6 + 13), kPixels / 4 * kHypotheses * (9 + 4 * 7 + 2), &state);
}

void Match(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchSemiGlobally(Hall().first, Hall().second, {}));
  }
  StateFloors(kPixels * (2 + 4), kPixels / 4 * 16 * (9 + 4 * 7 + 2) * 4 / 3, &state);
}

void Refine(benchmark::State& state) {
  const cv::Mat disparity = MatchSemiGlobally(Hall().first, Hall().second, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(RefineDisparities(Hall().first, Hall().second, disparity, {}));
  }
  // In floats, each of which counts as four bytes. A step interpolates (3), takes a gradient (2)
  // and sums five products over a window, which running sums do in 2 x 2 operations each.
  StateFloors(kPixels * (2 + 4 + 8), kPixels * 2 * 4 * (3 + 2 + 5 * 5), &state);
}

void Speckles(benchmark::State& state) {
  const cv::Mat disparity = MatchSemiGlobally(Hall().first, Hall().second, {});
  for (auto _ : state) {
    cv::Mat cleaned = disparity.clone();
    RemoveSpeckles({}, &cleaned);
    benchmark::DoNotOptimize(cleaned.data);
  }
  StateFloors(kPixels * 8, kPixels * 4 * 4, &state);
}

void MatchTwoSpheres(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchSphere(Hall().reference, Hall().source, {}));
  }
}

void FindPlaneDisparities(benchmark::State& state) {
  const PlaneHypothesis floor{{0.1, 0.9, -0.4}, 1.5};
  for (auto _ : state) {
    benchmark::DoNotOptimize(PlaneDisparities(floor, 0.5, kWidth / 2));
  }
}

void MatchTwoSpheresAboveAPlane(benchmark::State& state) {
  const PlaneHypothesis floor{{0, 0, 1}, 1.5};
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchSphere(Hall().reference, Hall().source, {}, floor));
  }
}

BENCHMARK(Rectify)->Unit(benchmark::kMillisecond);
BENCHMARK(Search)->Unit(benchmark::kMillisecond);
BENCHMARK(Match)->Unit(benchmark::kMillisecond);
BENCHMARK(Refine)->Unit(benchmark::kMillisecond);
BENCHMARK(Speckles)->Unit(benchmark::kMillisecond);
BENCHMARK(MatchTwoSpheres)->Unit(benchmark::kMillisecond);
BENCHMARK(FindPlaneDisparities)->Unit(benchmark::kMillisecond);
BENCHMARK(MatchTwoSpheresAboveAPlane)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace orb360
