#pragma once

// The output stage of both bfloat16 units. Only for x86-64.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <immintrin.h>

#include "nn/kernels/convolution_bf16.h"

#define ORB360_AVX512_BF16 __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq,avx512bf16")))

namespace orb360::nn {

/// Sums of up to 32 pixels of a row and half a group: [pixel][output channel].
using BFloat16Sums = float[2 * 16 * kBFloat16Half];

/// Reads 16 bfloat16 as floats. (The masked form is used because GCC 12 warns about the
/// placeholders of the other forms.)
ORB360_AVX512_BF16 inline __m512 Widen(const std::uint16_t* from) {
  const auto bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  constexpr __mmask16 kAll = 0xffff;
  return _mm512_castsi512_ps(
      _mm512_maskz_slli_epi32(kAll, _mm512_maskz_cvtepu16_epi32(kAll, bits), 16));
}

/// Adds bias and residual to the sums of `pixels` pixels from (y, x) on, applies the activation,
/// and writes them.
ORB360_AVX512_BF16 inline void StoreSums(const BFloat16Convolution& run, int group, int y, int x,
                                         int pixels, const BFloat16Sums* sums) {
  const TensorView& out = run.output;
  const TensorView& residual = run.residual;
  const __m512 zero = _mm512_setzero_ps();
  const __m512 slope = _mm512_set1_ps(run.slope);
  // NaN fails the comparison and stays NaN.
  const auto activate = [&](__m512 value) ORB360_AVX512_BF16 {
    return _mm512_mask_mul_ps(value, _mm512_cmp_ps_mask(value, zero, _CMP_NGT_UQ), value, slope);
  };
  const int halves = HalvesInGroup(group, out.shape.channels);
  if (out.type == DataType::kBFloat16) {
    std::uint16_t* to = out.row<std::uint16_t>(group, y) + std::ptrdiff_t{x} * kBFloat16Group;
    const std::uint16_t* add = residual.data == nullptr ? nullptr
                                                        : residual.row<std::uint16_t>(group, y) +
                                                              std::ptrdiff_t{x} * kBFloat16Group;
    const int exist = std::min(kBFloat16Group, out.shape.channels - group * kBFloat16Group);
    const auto mask = static_cast<__mmask32>((std::uint64_t{1} << exist) - 1);
    const __m512 bias0 = _mm512_load_ps(run.bias + group * kBFloat16Group);
    const __m512 bias1 = _mm512_load_ps(run.bias + group * kBFloat16Group + kBFloat16Half);
    for (int p = 0; p < pixels; ++p, to += kBFloat16Group) {
      __m512 low = _mm512_add_ps(_mm512_load_ps(sums[0] + p * kBFloat16Half), bias0);
      __m512 high =
          halves == 1 ? zero : _mm512_add_ps(_mm512_load_ps(sums[1] + p * kBFloat16Half), bias1);
      if (add != nullptr) {
        low = _mm512_add_ps(low, Widen(add + p * kBFloat16Group));
        high = _mm512_add_ps(high, Widen(add + p * kBFloat16Group + kBFloat16Half));
      }
      const __m512bh rounded = _mm512_cvtne2ps_pbh(activate(high), activate(low));
      __m512i bits;
      __builtin_memcpy(&bits, &rounded, sizeof(bits));
      // Channels that fill up the last block are zero, also if the sums are infinite.
      _mm512_storeu_si512(to, _mm512_maskz_mov_epi16(mask, bits));
    }
    return;
  }
  for (int half = 0; half < halves; ++half) {
    const int channel = group * kBFloat16Group + half * kBFloat16Half;
    const int exist = std::min(kBFloat16Half, out.shape.channels - channel);
    const __m512 bias = _mm512_load_ps(run.bias + channel);
    if (out.layout == Layout::kBlocked) {
      const auto mask = static_cast<__mmask16>((1u << exist) - 1);
      const int plane = channel / kBFloat16Half;
      float* to = out.row<float>(plane, y) + std::ptrdiff_t{x} * kBFloat16Half;
      for (int p = 0; p < pixels; ++p) {
        __m512 value = _mm512_add_ps(_mm512_load_ps(sums[half] + p * kBFloat16Half), bias);
        if (residual.data != nullptr) {
          value = _mm512_add_ps(value, _mm512_loadu_ps(residual.row<float>(plane, y) +
                                                       std::ptrdiff_t{x + p} * kBFloat16Half));
        }
        _mm512_storeu_ps(to + p * kBFloat16Half, _mm512_maskz_mov_ps(mask, activate(value)));
      }
      continue;
    }
    const __m512i pixel_offsets =
        _mm512_mullo_epi32(_mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0),
                           _mm512_set1_epi32(kBFloat16Half));
    for (int c = 0; c < exist; ++c) {
      for (int p = 0; p < pixels; p += 16) {
        const auto mask = static_cast<__mmask16>((1u << std::min(16, pixels - p)) - 1);
        __m512 value = _mm512_mask_i32gather_ps(zero, mask, pixel_offsets,
                                                sums[half] + p * kBFloat16Half + c, sizeof(float));
        value = _mm512_add_ps(value, _mm512_set1_ps(run.bias[channel + c]));
        if (residual.data != nullptr) {
          value = _mm512_add_ps(
              value, _mm512_maskz_loadu_ps(mask, residual.row<float>(channel + c, y) + x + p));
        }
        _mm512_mask_storeu_ps(out.row<float>(channel + c, y) + x + p, mask, activate(value));
      }
    }
  }
}

/// Stores the sums of every tile one tile later, so that the vector units work while the next tile
/// multiplies, and not in turn with it.
class LateStore {
 public:
  explicit LateStore(const BFloat16Convolution& run) : run_(run) {}
  LateStore(const LateStore&) = delete;
  LateStore& operator=(const LateStore&) = delete;

  /// Memory for the sums of the next tile.
  BFloat16Sums* next() { return sums_[next_]; }
  /// States that the sums in next() are those of `pixels` pixels from (y, x) on.
  ORB360_AVX512_BF16 void Push(int group, int y, int x, int pixels) {
    Flush();
    waiting_ = {group, y, x, pixels};
    next_ = 1 - next_;
  }
  ORB360_AVX512_BF16 void Flush() {
    if (waiting_.pixels == 0) return;
    StoreSums(run_, waiting_.group, waiting_.y, waiting_.x, waiting_.pixels, sums_[1 - next_]);
    waiting_.pixels = 0;
  }

 private:
  struct Waiting {
    int group = 0;
    int y = 0;
    int x = 0;
    int pixels = 0;
  };

  const BFloat16Convolution& run_;
  Waiting waiting_;
  int next_ = 0;
  alignas(64) BFloat16Sums sums_[2][2];
};

}  // namespace orb360::nn
