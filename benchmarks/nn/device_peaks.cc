#include "benchmarks/nn/device_peaks.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include <omp.h>

#include "benchmarks/nn/fma_peak.h"
#include "nn/base/cpu.h"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace orb360::nn {
namespace {

double Seconds(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

#if defined(__x86_64__) || defined(__aarch64__)

constexpr std::int64_t kSteps = 100'000;

// `products` are those that `run` makes in a step.
double MeasureUnit(void (*run)(), int products, int threads) {
  const auto start = std::chrono::steady_clock::now();
#pragma omp parallel num_threads(threads)
  run();
  return 2e-9 * products * kSteps * threads / Seconds(start);
}

#endif

#if defined(__x86_64__)

constexpr int kSums = 12;  // as in fma_peak.cc
constexpr int kLanes = 16;

// The assembly keeps the compiler from summing in another way.
__attribute__((target("avx512f,avx512bw,avx512vl,avx512vnni"))) void AddBytes() {
  __m512i sum[kSums];
  for (auto& value : sum) value = _mm512_setzero_si512();
  const __m512i factor = _mm512_set1_epi32(1);
  for (std::int64_t step = 0; step < kSteps; ++step) {
#pragma GCC unroll 12
    for (auto& value : sum) asm volatile("vpdpbusd %1, %1, %0" : "+v"(value) : "v"(factor));
  }
}

__attribute__((target("avx512f,avx512bw,avx512vl,avx512bf16"))) void AddBFloat16() {
  __m512 sum[kSums];
  for (auto& value : sum) value = _mm512_setzero_ps();
  const __m512 factor = _mm512_setzero_ps();
  for (std::int64_t step = 0; step < kSteps; ++step) {
#pragma GCC unroll 12
    for (auto& value : sum) asm volatile("vdpbf16ps %1, %1, %0" : "+v"(value) : "v"(factor));
  }
}

#elif defined(__aarch64__)

constexpr int kSums = 16;  // 4 units with a latency of 4 cycles
constexpr int kLanes = 4;

#if defined(__clang__)
__attribute__((target("dotprod")))
#else
__attribute__((target("arch=armv8.2-a+dotprod")))
#endif
void AddBytes() {
  const int8x16_t factor = vdupq_n_s8(1);
  int32x4_t sum[kSums];
  for (auto& value : sum) value = vdupq_n_s32(0);
  for (std::int64_t step = 0; step < kSteps; ++step) {
#pragma GCC unroll 16
    for (auto& value : sum) asm volatile("sdot %0.4s, %1.16b, %1.16b" : "+w"(value) : "w"(factor));
  }
}

#endif

// A copy, which reads each line, and reads it before it is written.
double MeasureBandwidth(int threads) {
  constexpr std::size_t kFloats = std::size_t{16} << 20;  // 64 MiB each: more than caches hold
  static std::vector<float> from(kFloats, 1.0f);
  static std::vector<float> to(kFloats);
  const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for num_threads(threads)
  for (int part = 0; part < threads; ++part) {
    const std::size_t begin = kFloats * part / threads;
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin),
              from.begin() + static_cast<std::ptrdiff_t>(kFloats * (part + 1) / threads),
              to.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  return 2e-9 * kFloats * sizeof(float) / Seconds(start);
}

}  // namespace

double MeasureBFloat16Peak([[maybe_unused]] int threads) {
#if defined(__x86_64__)
  if (BestBFloat16Unit() != BFloat16Unit::kNone)
    return MeasureUnit(AddBFloat16, kLanes * 2 * kSums, threads);
#endif
  return 0;
}

double MeasureBytePeak([[maybe_unused]] int threads) {
#if defined(__x86_64__) || defined(__aarch64__)
  if (FindByteUnit() != ByteUnit::kNone) return MeasureUnit(AddBytes, kLanes * 4 * kSums, threads);
#endif
  return 0;
}

Peaks MeasurePeaks(int threads) {
  constexpr int kTimes = 20;
  Peaks best;
  for (int i = 0; i < kTimes; ++i) {
    best.fma = std::max(best.fma, MeasureFmaPeak(threads));
    best.bfloat16 = std::max(best.bfloat16, MeasureBFloat16Peak(threads));
    best.bytes = std::max(best.bytes, MeasureBytePeak(threads));
    best.bandwidth = std::max(best.bandwidth, MeasureBandwidth(threads));
  }
  return best;
}

}  // namespace orb360::nn
