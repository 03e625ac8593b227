// Every operation but convolution, at the sizes of the network for 512 x 1024, and the two networks
// of normalized convolutions; benchmarks/nn/networks times those beside PyTorch.
#include <algorithm>
#include <functional>
#include <vector>

#include <benchmark/benchmark.h>

#include "nn/kernels/average_pool.h"
#include "nn/kernels/confidence_pool.h"
#include "nn/kernels/convex_upsample.h"
#include "nn/kernels/dense.h"
#include "nn/kernels/elementwise.h"
#include "nn/kernels/median_log.h"
#include "nn/kernels/normalized_chain.h"
#include "nn/kernels/upsample.h"
#include "tests/nn/kernels/propagation_network.h"

namespace orb360::nn {
namespace {

constexpr int kHeight = 512;
constexpr int kWidth = 1024;
constexpr Padding kPadding = Padding::kWrapReplicate;

TensorFormat Format(const Shape& shape, Layout layout = Layout::kPlanar) {
  return {shape, layout, DataType::kFloat, 1};
}

// One pixel in twenty is known.
PlainImage SparseConfidence(const Shape& shape) {
  PlainImage c = RandomImage(shape, -19.0f, 1.0f, 9);
  for (double& value : c.values) value = std::max(value, 0.0);
  return c;
}

// The argument of every benchmark is the number of threads.
void TimeNetwork(benchmark::State& state, PropagationNetwork network) {
  const FilledTensor x(RandomImage({1, kHeight, kWidth}, 1.0f, 80.0f, 1), Layout::kPlanar, 0);
  const FilledTensor c(SparseConfidence({1, kHeight, kWidth}), Layout::kPlanar, 0);
  const TensorMemory y(Format({1, kHeight, kWidth}));
  const TensorMemory y_confidence(Format({1, kHeight, kWidth}));
  for (auto _ : state) network.Run({x.view, c.view}, {y.view, y_confidence.view});
}

void UnguidedNetworkPublished(benchmark::State& state) {
  const int threads = static_cast<int>(state.range(0));
  TimeNetwork(state, UnguidedNetwork(RandomUnguidedLayers(), kHeight, kWidth, threads));
}

void PropagationSevenLevels(benchmark::State& state) {
  const int threads = static_cast<int>(state.range(0));
  TimeNetwork(state, SevenLevelNetwork(kPadding, kHeight, kWidth, threads));
}

// outputs, inputs, size; beside the time the multiply-adds of both sums in GFLOP/s.
void NormalizedConvolutionLayer(benchmark::State& state) {
  const int threads = static_cast<int>(state.range(0));
  const int outputs = static_cast<int>(state.range(1));
  const int inputs = static_cast<int>(state.range(2));
  const int size = static_cast<int>(state.range(3));
  const NormalizedChain chain({RandomLayer(outputs, inputs, size, kPadding, 1)});
  const Shape in{inputs, kHeight, kWidth};
  const FilledTensor x(RandomImage(in, -3.0f, 3.0f, 1), Layout::kPlanar, 0);
  const FilledTensor c(RandomImage(in, 0.0f, 1.0f, 2), Layout::kPlanar, 0);
  const TensorMemory y(Format({outputs, kHeight, kWidth}));
  const TensorMemory y_confidence(Format({outputs, kHeight, kWidth}));
  const Scratch scratch(chain.ScratchBytes(kWidth, threads));
  const NormalizedInput input{{x.view, c.view}};
  for (auto _ : state) {
    chain.Run({&input, 1}, {y.view, y_confidence.view}, scratch.bytes, threads);
  }
  state.counters["GFLOP/s"] =
      benchmark::Counter(4e-9 * outputs * inputs * size * size * kHeight * kWidth,
                         benchmark::Counter::kIsIterationInvariantRate);
}

// Bytes of inputs and outputs over the time tell how far an operation is from the memory's speed.
void Time(benchmark::State& state, std::size_t values, const std::function<void(int)>& run) {
  const int threads = static_cast<int>(state.range(0));
  for (auto _ : state) run(threads);
  state.counters["GB/s"] = benchmark::Counter(1e-9 * sizeof(float) * values,
                                              benchmark::Counter::kIsIterationInvariantRate);
}

std::size_t Count(const Shape& shape) {
  return static_cast<std::size_t>(shape.channels) * shape.height * shape.width;
}

void PoolByConfidence(benchmark::State& state) {
  const Shape shape{2, kHeight, kWidth};
  const FilledTensor x(RandomImage(shape, -3.0f, 3.0f, 1), Layout::kPlanar, 0);
  const FilledTensor c(SparseConfidence(shape), Layout::kPlanar, 0);
  const TensorMemory y(Format({2, kHeight / 2, kWidth / 2}));
  const TensorMemory y_confidence(Format({2, kHeight / 2, kWidth / 2}));
  Time(state, Count(shape) * 5 / 2, [&](int threads) {
    ConfidencePool(x.view, c.view, y.view, y_confidence.view, ConfidenceRule::kSquareRoot, threads);
  });
}

void MedianLogarithm(benchmark::State& state) {
  const Shape shape{1, kHeight, kWidth};
  const FilledTensor depth(RandomImage(shape, 1.0f, 80.0f, 1), Layout::kPlanar, 0);
  const FilledTensor confidence(SparseConfidence(shape), Layout::kPlanar, 0);
  const TensorMemory x(Format(shape));
  const TensorMemory c(Format(shape));
  const TensorMemory median(Format({1, 1, 1}));
  Time(state, 4 * Count(shape), [&](int threads) {
    MedianLog(depth.view, confidence.view, x.view, c.view, median.view, threads);
  });
}

void Convex(benchmark::State& state) {
  const Shape half{1, kHeight / 2, kWidth / 2};
  const Shape stack{ConvexUpsampleWeights(2), kHeight / 2, kWidth / 2};
  const FilledTensor x(RandomImage(half, -3.0f, 3.0f, 1), Layout::kPlanar, 1);
  const FilledTensor weights(RandomImage(stack, -3.0f, 3.0f, 1), Layout::kPlanar, 0);
  const TensorMemory y(Format({1, kHeight, kWidth}));
  Time(state, Count(stack) + 5 * Count(half),
       [&](int threads) { ConvexUpsample(x.view, weights.view, y.view, 2, kPadding, threads); });
}

// The skip of the decoder's largest level: up-sampled there, pooled back.
constexpr Shape kSmall{32, kHeight / 4, kWidth / 4};
constexpr Shape kLarge{32, kHeight / 2, kWidth / 2};

void Nearest(benchmark::State& state) {
  const FilledTensor x(RandomImage(kSmall, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  const TensorMemory y(Format(kLarge, Layout::kBlocked));
  Time(state, 5 * Count(kSmall), [&](int threads) { UpsampleNearest(x.view, y.view, threads); });
}

void Bilinear(benchmark::State& state) {
  const FilledTensor x(RandomImage(kSmall, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  const TensorMemory y(Format(kLarge, Layout::kBlocked));
  Time(state, 5 * Count(kSmall),
       [&](int threads) { UpsampleBilinear(x.view, y.view, kPadding, threads); });
}

void AverageOfSquares(benchmark::State& state) {
  const FilledTensor x(RandomImage(kLarge, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  const TensorMemory y(Format(kSmall, Layout::kBlocked));
  Time(state, 5 * Count(kSmall), [&](int threads) { AveragePool(x.view, y.view, threads); });
}

void AverageOfAll(benchmark::State& state) {
  const Shape shape{160, kHeight / 32, kWidth / 32};
  const FilledTensor x(RandomImage(shape, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  const TensorMemory y(Format({160, 1, 1}, Layout::kBlocked));
  Time(state, Count(shape), [&](int threads) { GlobalAveragePool(x.view, y.view, threads); });
}

void DenseLayer(benchmark::State& state) {
  const Dense dense(RandomFloats(64 * 160, -1, 1, 1), RandomFloats(64, -1, 1, 2), 64, 160);
  const FilledTensor x(RandomImage({160, 1, 1}, -3.0f, 3.0f, 1), Layout::kBlocked, 0);
  const TensorMemory y(Format({64, 1, 1}, Layout::kBlocked));
  Time(state, 64 * 160, [&](int) { dense.Run(x.view, y.view); });
}

using Unary = void (*)(const TensorView&, const TensorView&, int);

template <Unary kFunction>
void OneByOne(benchmark::State& state) {
  const Shape shape{1, kHeight, kWidth};
  const FilledTensor x(RandomImage(shape, 0.1f, 3.0f, 1), Layout::kPlanar, 0);
  const TensorMemory y(Format(shape));
  Time(state, 2 * Count(shape), [&](int threads) { kFunction(x.view, y.view, threads); });
}

void AddTensors(benchmark::State& state) {
  const FilledTensor x(RandomImage(kLarge, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  const FilledTensor y(RandomImage(kLarge, -3.0f, 3.0f, 1), Layout::kBlocked, 1);
  Time(state, 3 * Count(kLarge), [&](int threads) { Add(x.view, y.view, y.view, threads); });
}

// Minima of repetitions are what a busy machine disturbs least.
#define ORB360_TIMED(...)                                               \
  BENCHMARK(__VA_ARGS__)                                                \
      ->Unit(benchmark::kMicrosecond)                                   \
      ->UseRealTime()                                                   \
      ->MeasureProcessCPUTime()                                         \
      ->ComputeStatistics("min", [](const std::vector<double>& times) { \
        return *std::min_element(times.begin(), times.end());           \
      })
ORB360_TIMED(UnguidedNetworkPublished)->Arg(1)->Arg(2);
ORB360_TIMED(PropagationSevenLevels)->Arg(1)->Arg(2);
ORB360_TIMED(NormalizedConvolutionLayer)
    ->ArgNames({"threads", "out", "in", "size"})
    ->ArgsProduct({{1, 2}, {2}, {1}, {5}})
    ->ArgsProduct({{1, 2}, {2}, {2}, {5}})
    ->ArgsProduct({{1, 2}, {2}, {4}, {3}})
    ->ArgsProduct({{1, 2}, {1}, {2}, {1}})
    ->ArgsProduct({{1, 2}, {3}, {3}, {3}});
ORB360_TIMED(PoolByConfidence)->Arg(1)->Arg(2);
ORB360_TIMED(MedianLogarithm)->Arg(1)->Arg(2);
ORB360_TIMED(Convex)->Arg(1)->Arg(2);
ORB360_TIMED(Nearest)->Arg(1)->Arg(2);
ORB360_TIMED(Bilinear)->Arg(1)->Arg(2);
ORB360_TIMED(AverageOfSquares)->Arg(1)->Arg(2);
ORB360_TIMED(AverageOfAll)->Arg(1)->Arg(2);
ORB360_TIMED(DenseLayer)->Arg(1);
ORB360_TIMED(OneByOne<Exp>)->Arg(1)->Arg(2);
ORB360_TIMED(OneByOne<Log>)->Arg(1)->Arg(2);
ORB360_TIMED(OneByOne<Tanh>)->Arg(1)->Arg(2);
ORB360_TIMED(OneByOne<Sigmoid>)->Arg(1)->Arg(2);
ORB360_TIMED(OneByOne<Softplus>)->Arg(1)->Arg(2);
ORB360_TIMED(OneByOne<Relu>)->Arg(1)->Arg(2);
ORB360_TIMED(AddTensors)->Arg(1)->Arg(2);

}  // namespace
}  // namespace orb360::nn
