#include "benchmarks/nn/fma_peak.h"

#include <chrono>
#include <cstdint>

#include <orb360/nn/base/aligned_vector.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "benchmarks/nn/fma_peak.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kMaxLanes = 16;  // of the vectors that convolutions use

// Twelve sums cover a latency of 4 cycles at 2 or 3 FMAs a cycle and fit 16 registers.
constexpr int kSums = 12;

// `values` are those the sums start from: they must differ, or the compiler would keep only one.
double MultiplyAdd(int64_t steps, float* values) {
  const hn::CappedTag<float, kMaxLanes> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  hn::Vec<decltype(d)> sum[kSums];
  for (int i = 0; i < kSums; ++i) sum[i] = hn::Load(d, values + i * lanes);
  // Sums that start between 0 and 1 stay there: no infinities, no subnormal numbers.
  const auto scale = hn::Set(d, 0.5f);
  const auto offset = hn::Load(d, values);
  for (int64_t step = 0; step < steps; ++step) {
    HWY_UNROLL(12)
    for (int i = 0; i < kSums; ++i) sum[i] = hn::MulAdd(sum[i], scale, offset);
  }
  for (int i = 0; i < kSums; ++i) hn::Store(sum[i], d, values + i * lanes);
  return 2.0 * kSums * lanes * static_cast<double>(steps);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

constexpr int kMaxLanes = 16;

HWY_EXPORT(MultiplyAdd);

double MeasureFmaPeak(int threads) {
  constexpr int64_t kSteps = 300'000;  // of 6 cycles each
  constexpr int kValues = 12 * kMaxLanes;
  AlignedVector<float> values(static_cast<size_t>(threads) * kValues);
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i) / static_cast<float>(2 * values.size());
  }
  double operations = 0;
  const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for num_threads(threads) schedule(static, 1) reduction(+ : operations)
  for (int thread = 0; thread < threads; ++thread) {
    operations += HWY_DYNAMIC_DISPATCH(MultiplyAdd)(kSteps, values.data() + thread * kValues);
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  volatile float used = values.front();  // what nobody uses need not be computed
  static_cast<void>(used);
  return operations / taken.count() / 1e9;
}

}  // namespace orb360::nn
#endif
