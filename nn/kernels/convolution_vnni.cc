#include "nn/kernels/convolution_int8.h"

#if defined(__x86_64__)

#include <algorithm>
#include <atomic>
#include <utility>

#include <immintrin.h>

#define ORB360_VNNI __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")))

namespace orb360::nn {
namespace {

// As in convolution_direct.cc: 2 vectors of output channels x 14 pixels in registers.
constexpr int kPixels = 14;
// All lanes. GCC 12 warns about the placeholders of the forms without a mask.
constexpr __mmask16 kAll = 0xffff;
constexpr __mmask8 kEight = 0xff;

using Bytes = ByteBand<std::uint8_t>;

// Rounds `count` blocks of 16 floats.
ORB360_VNNI void Round(const float* from, std::ptrdiff_t count, const ByteScale& scale,
                       std::uint8_t* to) {
  const __m512 steps = _mm512_set1_ps(scale.steps);
  const __m512i zero = _mm512_set1_epi32(scale.zero);
  // The largest input: what is larger would not fit an integer. NaN becomes this too.
  const __m512 high = _mm512_set1_ps(static_cast<float>(255 - scale.zero));
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const __m512 value = _mm512_loadu_ps(from + i * kInt8Block);
    const __m512 limited = _mm512_maskz_min_ps(kAll, _mm512_mul_ps(value, steps), high);
    const __m512i whole = _mm512_add_epi32(_mm512_maskz_cvtps_epi32(kAll, limited), zero);
    const __m512i byte = _mm512_maskz_max_epi32(kAll, whole, _mm512_setzero_si512());
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i * kInt8Block),
                     _mm512_maskz_cvtepi32_epi8(kAll, byte));
  }
}

struct Row {
  const Int8Convolution& run;
  Bytes bytes;  // at the first tap of the first pixel of the row
  int first_channel;
  int y;
};

// NaN, which a residual may have, fails the comparison and stays NaN.
ORB360_VNNI __m512 Activate(__m512 value, __m512 slope) {
  return _mm512_mask_mul_ps(value, _mm512_cmp_ps_mask(value, _mm512_setzero_ps(), _CMP_NGT_UQ),
                            value, slope);
}

// Writes `count` pixels of one block after residual and activation: [pixel][channel].
ORB360_VNNI void StoreBlocked(const Int8Convolution& run, int channel, int y, int x, int count,
                              const float* values) {
  const __m512 slope = _mm512_set1_ps(run.slope);
  // Channels that fill up the last block are zero.
  const int exist = std::clamp(run.output.shape.channels - channel, 0, kInt8Half);
  const auto mask = static_cast<__mmask16>((1u << exist) - 1);
  const int plane = channel / kInt8Half;
  const std::ptrdiff_t at = std::ptrdiff_t{x} * kInt8Half;
  float* out = run.output.row<float>(plane, y) + at;
  const float* added =
      run.residual.data == nullptr ? nullptr : run.residual.row<float>(plane, y) + at;
  for (int p = 0; p < count; ++p) {
    __m512 value = _mm512_load_ps(values + p * kInt8Half);
    if (added != nullptr) value = _mm512_add_ps(value, _mm512_loadu_ps(added + p * kInt8Half));
    _mm512_storeu_ps(out + p * kInt8Half, _mm512_maskz_mov_ps(mask, Activate(value, slope)));
  }
}

// Exchanges rows and columns of 16 x 16 floats.
ORB360_VNNI void Transpose(__m512 (&rows)[16]) {
  __m512 half[16];
  for (int i = 0; i < 16; i += 4) {  // 4 x 4 in every 128 bits
    const __m512d low01 = _mm512_castps_pd(_mm512_maskz_unpacklo_ps(kAll, rows[i], rows[i + 1]));
    const __m512d high01 = _mm512_castps_pd(_mm512_maskz_unpackhi_ps(kAll, rows[i], rows[i + 1]));
    const __m512d low23 =
        _mm512_castps_pd(_mm512_maskz_unpacklo_ps(kAll, rows[i + 2], rows[i + 3]));
    const __m512d high23 =
        _mm512_castps_pd(_mm512_maskz_unpackhi_ps(kAll, rows[i + 2], rows[i + 3]));
    half[i] = _mm512_castpd_ps(_mm512_maskz_unpacklo_pd(kEight, low01, low23));
    half[i + 1] = _mm512_castpd_ps(_mm512_maskz_unpackhi_pd(kEight, low01, low23));
    half[i + 2] = _mm512_castpd_ps(_mm512_maskz_unpacklo_pd(kEight, high01, high23));
    half[i + 3] = _mm512_castpd_ps(_mm512_maskz_unpackhi_pd(kEight, high01, high23));
  }
  for (int i = 0; i < 4; ++i) {  // 4 x 4 of these squares
    const __m512 even01 = _mm512_maskz_shuffle_f32x4(kAll, half[i], half[i + 4], 0x88);
    const __m512 odd01 = _mm512_maskz_shuffle_f32x4(kAll, half[i], half[i + 4], 0xdd);
    const __m512 even23 = _mm512_maskz_shuffle_f32x4(kAll, half[i + 8], half[i + 12], 0x88);
    const __m512 odd23 = _mm512_maskz_shuffle_f32x4(kAll, half[i + 8], half[i + 12], 0xdd);
    rows[i] = _mm512_maskz_shuffle_f32x4(kAll, even01, even23, 0x88);
    rows[i + 4] = _mm512_maskz_shuffle_f32x4(kAll, odd01, odd23, 0x88);
    rows[i + 8] = _mm512_maskz_shuffle_f32x4(kAll, even01, even23, 0xdd);
    rows[i + 12] = _mm512_maskz_shuffle_f32x4(kAll, odd01, odd23, 0xdd);
  }
}

// The same to planes.
ORB360_VNNI void StorePlanar(const Int8Convolution& run, int channel, int y, int x, int count,
                             const float* values) {
  const __m512 slope = _mm512_set1_ps(run.slope);
  __m512 rows[16];
  for (int p = 0; p < 16; ++p) {
    rows[p] = p < count ? _mm512_load_ps(values + p * kInt8Half) : _mm512_setzero_ps();
  }
  Transpose(rows);
  const auto mask = static_cast<__mmask16>((1u << count) - 1);
  const int exist = std::min(run.output.shape.channels - channel, kInt8Half);
  for (int c = 0; c < exist; ++c) {
    __m512 value = rows[c];
    if (run.residual.data != nullptr) {
      value = _mm512_add_ps(
          value, _mm512_maskz_loadu_ps(mask, run.residual.row<float>(channel + c, y) + x));
    }
    _mm512_mask_storeu_ps(run.output.row<float>(channel + c, y) + x, mask, Activate(value, slope));
  }
}

// Computes kCount pixels from column x on of kHalves * 16 output channels.
template <int kHalves, int kCount, int kStride>
ORB360_VNNI void Compute(const Row& row, int x, const std::int8_t* weight) {
  const Int8Convolution& run = row.run;
  __m512i sum[kHalves][kCount];
#pragma GCC unroll 2
  for (int h = 0; h < kHalves; ++h) {
    const __m512i first =
        _mm512_loadu_si512(run.weights->first_sum.data() + row.first_channel + h * kInt8Half);
#pragma GCC unroll 14
    for (int p = 0; p < kCount; ++p) sum[h][p] = first;
  }
  const std::uint8_t* in = row.bytes.data + std::ptrdiff_t{x} * kStride * kInt8Block;
  const int blocks = run.input.planes();
  for (int block = 0; block < blocks; ++block, in += row.bytes.plane) {
    for (int v = 0; v < run.kernel; ++v) {
      for (int u = 0; u < run.kernel; ++u) {
        const std::uint8_t* at = in + v * row.bytes.row + u * kInt8Block;
#pragma GCC unroll 4
        for (int quad = 0; quad < kInt8Block / kInt8Quad; ++quad) {
          __m512i w[kHalves];
#pragma GCC unroll 2
          for (int h = 0; h < kHalves; ++h) {
            w[h] = _mm512_load_si512(weight + (quad * kHalves + h) * kAlignment);
          }
#pragma GCC unroll 14
          for (int p = 0; p < kCount; ++p) {
            std::int32_t four;
            __builtin_memcpy(&four, at + p * kStride * kInt8Block + quad * kInt8Quad, sizeof(four));
            const __m512i inputs = _mm512_set1_epi32(four);
#pragma GCC unroll 2
            for (int h = 0; h < kHalves; ++h) {
              asm("vpdpbusd %2, %1, %0" : "+v"(sum[h][p]) : "v"(inputs), "v"(w[h]));
            }
          }
          // This keeps the compiler from loading ahead, because no register is free.
          std::atomic_signal_fence(std::memory_order_acq_rel);
        }
        weight += kInt8Block / kInt8Quad * kHalves * kAlignment;
      }
    }
  }
#pragma GCC unroll 2
  for (int h = 0; h < kHalves; ++h) {
    const int channel = row.first_channel + h * kInt8Half;
    const __m512 scale = _mm512_loadu_ps(run.weights->scale.data() + channel);
    const __m512 bias = _mm512_loadu_ps(run.bias + channel);
    alignas(kAlignment) float values[kPixels * kInt8Half];
#pragma GCC unroll 14
    for (int p = 0; p < kCount; ++p) {
      const __m512 value = _mm512_fmadd_ps(_mm512_maskz_cvtepi32_ps(kAll, sum[h][p]), scale, bias);
      _mm512_store_ps(values + p * kInt8Half, value);
    }
    if (run.output.layout == Layout::kBlocked) {
      StoreBlocked(run, channel, row.y, x, kCount, values);
    } else {
      StorePlanar(run, channel, row.y, x, kCount, values);
    }
  }
}

using Function = void (*)(const Row&, int, const std::int8_t*);

// A table of the functions for 1, 2, ... pixels.
template <int kHalves, int kStride, int... kIndex>
const Function* Functions(std::integer_sequence<int, kIndex...>) {
  static constexpr Function kFunctions[] = {&Compute<kHalves, kIndex + 1, kStride>...};
  return kFunctions;
}

const Function* Functions(int halves, int stride) {
  constexpr auto kCounts = std::make_integer_sequence<int, kPixels>();
  if (halves == 1) return stride == 1 ? Functions<1, 1>(kCounts) : Functions<1, 2>(kCounts);
  return stride == 1 ? Functions<2, 1>(kCounts) : Functions<2, 2>(kCounts);
}

}  // namespace

void RunVnni(const Int8Convolution& run, int first, int last, std::byte* scratch) {
  const int width = run.output.shape.width;
  const Bytes band = RoundBand<std::uint8_t>(run, first, last, scratch, Round);
  const int tiles = (width + kPixels - 1) / kPixels;
  const std::int8_t* weight = run.weights->weight.data();
  const int channels = (run.output.shape.channels + kInt8Half - 1) / kInt8Half * kInt8Half;
  for (int channel = 0; channel < channels; channel += kInt8Group) {
    const int halves = std::min(kInt8Group, channels - channel) / kInt8Half;
    const Function* functions = Functions(halves, run.stride);
    for (int y = first; y < last; ++y) {
      const Row row{
          run, {band.data + (y - first) * run.stride * band.row, band.row, band.plane}, channel, y};
      for (int t = 0; t < tiles; ++t) {
        const int x = t * width / tiles;
        functions[(t + 1) * width / tiles - x - 1](row, x, weight);
      }
    }
    weight += std::ptrdiff_t{run.input.planes()} * run.kernel * run.kernel * halves * kInt8Half *
              kInt8Block;
  }
}

}  // namespace orb360::nn

#else

#include <orb360/nn/base/check.h>

namespace orb360::nn {

void RunVnni(const Int8Convolution&, int, int, std::byte*) {
  ORB360_CHECK(false, "this processor has no AVX-512 VNNI");
}

}  // namespace orb360::nn

#endif
