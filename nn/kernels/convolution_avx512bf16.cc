#include "nn/kernels/convolution_bf16.h"

#if defined(__x86_64__)

#include <utility>

#include "nn/kernels/convolution_bf16_store.h"

namespace orb360::nn {
namespace {

// As in convolution_direct.cc: 2 vectors of output channels x 14 pixels in registers.
constexpr int kPixels = 14;

// `in` is the first tap of the first pixel.
template <int kCount, int kStride>
ORB360_AVX512_BF16 void Multiply(const BFloat16Convolution& run, int halves,
                                 const std::uint16_t* in, const std::uint16_t* weight,
                                 BFloat16Sums* sums) {
  constexpr std::ptrdiff_t kBlock = BlockOf(DataType::kBFloat16);
  constexpr int kTile = 512;  // numbers
  __m512 sum[2][kCount];
#pragma GCC unroll 14
  for (int p = 0; p < kCount; ++p) sum[0][p] = sum[1][p] = _mm512_setzero_ps();
  const int blocks = run.input.planes();
  for (int block = 0; block < blocks; ++block, in += run.input.plane_stride) {
    for (int v = 0; v < run.kernel; ++v) {
      for (int u = 0; u < run.kernel; ++u) {
        const std::uint16_t* x = in + v * run.input.row_stride + u * kBlock;
        // A group of one half multiplies by it twice; the second sums are not used.
        const std::uint16_t* second = weight + (halves - 1) * kTile;
        for (int pair = 0; pair < kBlock / 2; ++pair) {
          __m512bh w0, w1;
          __builtin_memcpy(&w0, weight + pair * 32, sizeof(w0));
          __builtin_memcpy(&w1, second + pair * 32, sizeof(w1));
#pragma GCC unroll 14
          for (int p = 0; p < kCount; ++p) {
            std::int32_t both;
            __builtin_memcpy(&both, x + p * kStride * kBlock + 2 * pair, sizeof(both));
            const __m512i spread = _mm512_set1_epi32(both);
            __m512bh inputs;
            __builtin_memcpy(&inputs, &spread, sizeof(inputs));
            sum[0][p] = _mm512_dpbf16_ps(sum[0][p], inputs, w0);
            sum[1][p] = _mm512_dpbf16_ps(sum[1][p], inputs, w1);
          }
        }
        weight += halves * kTile;
      }
    }
  }
#pragma GCC unroll 14
  for (int p = 0; p < kCount; ++p) {
    _mm512_store_ps(sums[0] + p * kBFloat16Half, sum[0][p]);
    _mm512_store_ps(sums[1] + p * kBFloat16Half, sum[1][p]);
  }
}

using Function = void (*)(const BFloat16Convolution&, int, const std::uint16_t*,
                          const std::uint16_t*, BFloat16Sums*);

// A table of the functions for 1, 2, ... pixels.
template <int kStride, int... kIndex>
const Function* Functions(std::integer_sequence<int, kIndex...>) {
  static constexpr Function kFunctions[] = {&Multiply<kIndex + 1, kStride>...};
  return kFunctions;
}

}  // namespace

void RunAvx512BFloat16(const BFloat16Convolution& run, int first, int last) {
  constexpr std::ptrdiff_t kBlock = BlockOf(DataType::kBFloat16);
  constexpr auto kCounts = std::make_integer_sequence<int, kPixels>();
  const Function* functions = run.stride == 1 ? Functions<1>(kCounts) : Functions<2>(kCounts);
  const int reach = run.kernel / 2;
  const int width = run.output.shape.width;
  const int tiles = (width + kPixels - 1) / kPixels;
  const std::uint16_t* weight = run.weight;
  for (int group = 0; group * kBFloat16Group < run.output.shape.channels; ++group) {
    const int halves = HalvesInGroup(group, run.output.shape.channels);
    for (int y = first; y < last; ++y) {
      const std::uint16_t* in = run.input.row<std::uint16_t>(0, y * run.stride - reach);
      for (int t = 0; t < tiles; ++t) {
        const int x = t * width / tiles;
        const int end = (t + 1) * width / tiles;
        alignas(64) BFloat16Sums sums[2];
        functions[end - x - 1](run, halves, in + (x * run.stride - reach) * kBlock, weight, sums);
        StoreSums(run, group, y, x, end - x, sums);
      }
    }
    weight += std::ptrdiff_t{run.input.planes()} * run.kernel * run.kernel * halves * 512;
  }
}

}  // namespace orb360::nn

#else

#include <orb360/nn/base/check.h>

namespace orb360::nn {

void RunAvx512BFloat16(const BFloat16Convolution&, int, int) {
  ORB360_CHECK(false, "this processor has no AVX-512");
}

}  // namespace orb360::nn

#endif
