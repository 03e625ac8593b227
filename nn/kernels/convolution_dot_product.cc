#include "nn/kernels/convolution_int8.h"

#if defined(__aarch64__)

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include <arm_neon.h>

#if defined(__clang__)
#define ORB360_DOT_PRODUCT __attribute__((target("dotprod")))
#else
#define ORB360_DOT_PRODUCT __attribute__((target("arch=armv8.2-a+dotprod")))
#endif

namespace orb360::nn {
namespace {

// A tile is 16 output channels x 5 pixels. Its 20 sums, an input of each pixel and 4 vectors of
// weights take 29 of 32 registers; with 6 pixels gcc spills sums. It loads 16 + 5 vectors for 80
// products of vectors. 4 units with a latency of 4 cycles are busy with 16 sums.
constexpr int kPixels = 5;
constexpr int kLanes = 4;
constexpr int kVectors = kInt8Half / kLanes;

using Bytes = ByteBand<std::int8_t>;

// Rounds `count` blocks of 16 floats.
void Round(const float* from, std::ptrdiff_t count, const ByteScale& scale, std::int8_t* to) {
  const float32x4_t steps = vdupq_n_f32(scale.steps);
  const int32x4_t zero = vdupq_n_s32(scale.zero);
  // The largest input. NaN becomes this too.
  const float32x4_t high = vdupq_n_f32(static_cast<float>(scale.lowest + 255 - scale.zero));
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto quarter = [&](int at) {
      const float32x4_t value = vld1q_f32(from + i * kInt8Block + at);
      const float32x4_t limited = vminnmq_f32(vmulq_f32(value, steps), high);
      // What is too small stays the smallest integer in every one of these.
      return vqmovn_s32(vqaddq_s32(vcvtnq_s32_f32(limited), zero));
    };
    const int8x8_t low = vqmovn_s16(vcombine_s16(quarter(0), quarter(4)));
    vst1q_s8(to + i * kInt8Block,
             vcombine_s8(low, vqmovn_s16(vcombine_s16(quarter(8), quarter(12)))));
  }
}

struct Row {
  const Int8Convolution& run;
  Bytes bytes;  // at the first tap of the first pixel of the row
  int first_channel;
  int y;
};

// NaN, which a residual may have, fails the comparison and stays NaN.
float32x4_t Activate(float32x4_t value, float slope) {
  return vbslq_f32(vcgtzq_f32(value), value, vmulq_n_f32(value, slope));
}

// Writes pixels from column x on of one block after residual and activation.
template <int kCount>
void StoreBlocked(const Row& row, int x, const float32x4_t (&values)[kVectors][kCount]) {
  const Int8Convolution& run = row.run;
  const int plane = row.first_channel / kInt8Half;
  // Channels that fill up the last block are zero.
  const int exist = run.output.shape.channels - row.first_channel;
  const std::ptrdiff_t at = std::ptrdiff_t{x} * kInt8Half;
  float* out = run.output.row<float>(plane, row.y) + at;
  const float* added =
      run.residual.data == nullptr ? nullptr : run.residual.row<float>(plane, row.y) + at;
  constexpr std::uint32_t kNumbers[kLanes] = {0, 1, 2, 3};
  for (int v = 0; v < kVectors; ++v) {
    const auto left = static_cast<std::uint32_t>(std::clamp(exist - v * kLanes, 0, kLanes));
    const uint32x4_t mask = vcltq_u32(vld1q_u32(kNumbers), vdupq_n_u32(left));
    for (int p = 0; p < kCount; ++p) {
      const int offset = p * kInt8Half + v * kLanes;
      float32x4_t value = values[v][p];
      if (added != nullptr) value = vaddq_f32(value, vld1q_f32(added + offset));
      value = Activate(value, run.slope);
      vst1q_f32(out + offset, vreinterpretq_f32_u32(vandq_u32(vreinterpretq_u32_f32(value), mask)));
    }
  }
}

// The same to planes.
template <int kCount>
void StorePlanar(const Row& row, int x, const float32x4_t (&values)[kVectors][kCount]) {
  const Int8Convolution& run = row.run;
  constexpr int kPadded = (kCount + kLanes - 1) / kLanes * kLanes;
  const int exist = std::min(run.output.shape.channels - row.first_channel, kInt8Half);
  for (int c = 0; c < exist; ++c) {
    const int channel = row.first_channel + c;
    float pixels[kPadded] = {};
    for (int p = 0; p < kCount; ++p) pixels[p] = values[c / kLanes][p][c % kLanes];
    float more[kPadded] = {};
    if (run.residual.data != nullptr) {
      std::memcpy(more, run.residual.row<float>(channel, row.y) + x, kCount * sizeof(float));
    }
    for (int p = 0; p < kPadded; p += kLanes) {
      float32x4_t value = vld1q_f32(pixels + p);
      if (run.residual.data != nullptr) value = vaddq_f32(value, vld1q_f32(more + p));
      vst1q_f32(pixels + p, Activate(value, run.slope));
    }
    std::memcpy(run.output.row<float>(channel, row.y) + x, pixels, kCount * sizeof(float));
  }
}

// Adds the products of quad kQuad of a pixel's input channels. The instruction stands as assembly
// because clang has its intrinsic only where a whole file is compiled for it.
template <int kQuad, int kCount>
ORB360_DOT_PRODUCT inline __attribute__((always_inline)) void MultiplyAdd(
    const std::int8_t* weight, const int8x16_t (&inputs)[kCount],
    int32x4_t (&sum)[kVectors][kCount]) {
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v) {
    const int8x16_t w = vld1q_s8(weight + v * kLanes * kInt8Quad);
#pragma GCC unroll 5
    for (int p = 0; p < kCount; ++p) {
      asm("sdot %0.4s, %1.16b, %2.4b[%c3]" : "+w"(sum[v][p]) : "w"(w), "w"(inputs[p]), "i"(kQuad));
    }
  }
  // This keeps the compiler from loading ahead, because no register is free.
  std::atomic_signal_fence(std::memory_order_acq_rel);
}

// Computes kCount pixels from column x on of 16 output channels. From a quad's weights to those of
// the next one there are `step` bytes.
template <int kCount, int kStride>
ORB360_DOT_PRODUCT void Compute(const Row& row, int x, const std::int8_t* weight,
                                std::ptrdiff_t step) {
  const Int8Convolution& run = row.run;
  int32x4_t sum[kVectors][kCount];
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v) {
    const int32x4_t first =
        vld1q_s32(run.weights->first_sum.data() + row.first_channel + v * kLanes);
#pragma GCC unroll 5
    for (int p = 0; p < kCount; ++p) sum[v][p] = first;
  }
  const std::int8_t* in = row.bytes.data + std::ptrdiff_t{x} * kStride * kInt8Block;
  const int blocks = run.input.planes();
  const int kernel = run.kernel;
  for (int block = 0; block < blocks; ++block, in += row.bytes.plane) {
    for (int v = 0; v < kernel; ++v) {
      for (int u = 0; u < kernel; ++u) {
        const std::int8_t* at = in + v * row.bytes.row + u * kInt8Block;
        int8x16_t inputs[kCount];
#pragma GCC unroll 5
        for (int p = 0; p < kCount; ++p) inputs[p] = vld1q_s8(at + p * kStride * kInt8Block);
        MultiplyAdd<0>(weight, inputs, sum);
        MultiplyAdd<1>(weight + step, inputs, sum);
        MultiplyAdd<2>(weight + 2 * step, inputs, sum);
        MultiplyAdd<3>(weight + 3 * step, inputs, sum);
        weight += 4 * step;
      }
    }
  }
  float32x4_t values[kVectors][kCount];
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v) {
    const int channel = row.first_channel + v * kLanes;
    const float32x4_t scale = vld1q_f32(run.weights->scale.data() + channel);
    const float32x4_t bias = vld1q_f32(run.bias + channel);
#pragma GCC unroll 5
    for (int p = 0; p < kCount; ++p) {
      values[v][p] = vfmaq_f32(bias, vcvtq_f32_s32(sum[v][p]), scale);
    }
  }
  if (run.output.layout == Layout::kBlocked) {
    StoreBlocked(row, x, values);
  } else {
    StorePlanar(row, x, values);
  }
}

using Function = void (*)(const Row&, int, const std::int8_t*, std::ptrdiff_t);

// A table of the functions for 1, 2, ... pixels.
template <int kStride, int... kIndex>
const Function* Functions(std::integer_sequence<int, kIndex...>) {
  static constexpr Function kFunctions[] = {&Compute<kIndex + 1, kStride>...};
  return kFunctions;
}

}  // namespace

void RunDotProduct(const Int8Convolution& run, int first, int last, std::byte* scratch) {
  static_assert(kInt8Block / kInt8Quad == 4);
  constexpr auto kCounts = std::make_integer_sequence<int, kPixels>();
  const Function* functions = run.stride == 1 ? Functions<1>(kCounts) : Functions<2>(kCounts);
  const int width = run.output.shape.width;
  const Bytes band = RoundBand<std::int8_t>(run, first, last, scratch, Round);
  const int tiles = (width + kPixels - 1) / kPixels;
  constexpr std::ptrdiff_t kHalfBytes = kInt8Half * kInt8Quad;  // of a quad's weights
  const std::ptrdiff_t quads =
      std::ptrdiff_t{run.input.planes()} * run.kernel * run.kernel * kInt8Block / kInt8Quad;
  const std::int8_t* weight = run.weights->weight.data();
  const int channels = (run.output.shape.channels + kInt8Half - 1) / kInt8Half * kInt8Half;
  for (int group = 0; group < channels; group += kInt8Group) {
    const int halves = std::min(kInt8Group, channels - group) / kInt8Half;
    const std::ptrdiff_t step = halves * kHalfBytes;
    for (int y = first; y < last; ++y) {
      const Bytes in{band.data + (y - first) * run.stride * band.row, band.row, band.plane};
      for (int half = 0; half < halves; ++half) {
        const Row row{run, in, group + half * kInt8Half, y};
        for (int t = 0; t < tiles; ++t) {
          const int x = t * width / tiles;
          functions[(t + 1) * width / tiles - x - 1](row, x, weight + half * kHalfBytes, step);
        }
      }
    }
    weight += quads * step;
  }
}

}  // namespace orb360::nn

#else

#include <orb360/nn/base/check.h>

namespace orb360::nn {

void RunDotProduct(const Int8Convolution&, int, int, std::byte*) {
  ORB360_CHECK(false, "this processor has no dot product of Arm");
}

}  // namespace orb360::nn

#endif
