#include "nn/kernels/convolution_bf16.h"

#if defined(__x86_64__)

#include "nn/kernels/amx_tiles.h"
#include "nn/kernels/convolution_bf16_store.h"

namespace orb360::nn {
namespace {

// Pixels are rewritten as 8 bfloat16, so that a row of the window is 24 numbers in a row of memory:
// what a row of an input tile holds. Three products make a convolution of 3x3.
constexpr int kChannels = 8;
constexpr int kTaps = 3;
constexpr int kPairs = kTaps * kChannels / 2;
constexpr int kTileNumbers = kPairs * 2 * kTileRows;  // of weights

// Output pixels whose inputs are rounded in one go: tiles that are loaded right after they were
// stored would wait for the stores.
constexpr int kRun = 4 * kTilePixels;

// Inputs that kRun pixels see with a stride of 2, rounded up to whole vectors.
constexpr int kLine = (2 * (kRun - 1) + kTaps + 15) / 16 * 16;

// Rounds `count` pixels of up to 8 planes from `in` on to [pixel][channel].
ORB360_AVX512_BF16 void RoundLine(const TensorView& input, const float* in, int count,
                                  std::uint16_t* out) {
  // Pairs of channels are brought into the order in which turning squares of 4 x 4 pairs puts every
  // pixel in its place: lane group i, pair j is pixel 4 j + i.
  alignas(64) std::uint16_t order[32];
  for (int at = 0; at < 16; ++at) {
    const int pixel = at % 4 * 4 + at / 4;
    order[2 * at] = static_cast<std::uint16_t>(pixel);
    order[2 * at + 1] = static_cast<std::uint16_t>(16 + pixel);
  }
  // (Masked, because GCC 12 warns of the other forms' placeholders.)
  constexpr __mmask16 kAll32 = 0xffff;
  constexpr __mmask8 kAll64 = 0xff;
  const __m512i pair_order = _mm512_load_si512(order);
  for (int x = 0; x < count; x += 16) {
    const auto mask = static_cast<__mmask16>((1u << std::min(16, count - x)) - 1);
    __m512i pairs[kChannels / 2];
    for (int c = 0; c < kChannels; c += 2) {
      const auto load = [&](int channel) ORB360_AVX512_BF16 {
        if (channel >= input.shape.channels) return _mm512_setzero_ps();
        return _mm512_maskz_loadu_ps(mask, in + channel * input.plane_stride + x);
      };
      const __m512bh both = _mm512_cvtne2ps_pbh(load(c + 1), load(c));
      __m512i bits;
      __builtin_memcpy(&bits, &both, sizeof(bits));
      pairs[c / 2] = _mm512_permutexvar_epi16(pair_order, bits);
    }
    const __m512i low01 = _mm512_maskz_unpacklo_epi32(kAll32, pairs[0], pairs[1]);
    const __m512i high01 = _mm512_maskz_unpackhi_epi32(kAll32, pairs[0], pairs[1]);
    const __m512i low23 = _mm512_maskz_unpacklo_epi32(kAll32, pairs[2], pairs[3]);
    const __m512i high23 = _mm512_maskz_unpackhi_epi32(kAll32, pairs[2], pairs[3]);
    std::uint16_t* to = out + static_cast<std::ptrdiff_t>(x) * kChannels;
    _mm512_store_si512(to, _mm512_maskz_unpacklo_epi64(kAll64, low01, low23));
    _mm512_store_si512(to + 32, _mm512_maskz_unpackhi_epi64(kAll64, low01, low23));
    _mm512_store_si512(to + 64, _mm512_maskz_unpacklo_epi64(kAll64, high01, high23));
    _mm512_store_si512(to + 96, _mm512_maskz_unpackhi_epi64(kAll64, high01, high23));
  }
}

// The sums of up to 16 or 32 pixels, of which `lines` has the inputs, and all channels of a group.
ORB360_AMX void Multiply(const std::uint16_t* lines, int stride, int pixels, int halves,
                         const std::uint16_t* weight, BFloat16Sums* sums) {
  const std::ptrdiff_t step = std::ptrdiff_t{stride} * kChannels;
  _tile_zero(0);
  _tile_zero(1);
  _tile_zero(2);
  _tile_zero(3);
  for (int v = 0; v < kTaps; ++v) {
    const std::uint16_t* in = lines + static_cast<std::ptrdiff_t>(v) * kLine * kChannels;
    _tile_loadd(6, weight, 64);
    _tile_loadd(4, in, step * 2);
    _tile_dpbf16ps(0, 4, 6);
    if (halves == 2) {
      _tile_loadd(7, weight + kTileNumbers, 64);
      _tile_dpbf16ps(1, 4, 7);
    }
    if (pixels > kTileRows) {
      _tile_loadd(5, in + kTileRows * step, step * 2);
      _tile_dpbf16ps(2, 5, 6);
      if (halves == 2) _tile_dpbf16ps(3, 5, 7);
    }
    weight += halves * kTileNumbers;
  }
  _tile_stored(0, sums[0], 64);
  if (halves == 2) _tile_stored(1, sums[1], 64);
  if (pixels > kTileRows) {
    _tile_stored(2, sums[0] + kTileRows * kBFloat16Half, 64);
    if (halves == 2) _tile_stored(3, sums[1] + kTileRows * kBFloat16Half, 64);
  }
}

// Pixels `from` to `to` - 1 of some rows, `step` at a time, for which the tiles are shaped.
ORB360_AMX void RunColumns(const BFloat16Convolution& run, int first, int last, int from, int to,
                           int step) {
  alignas(64) std::uint16_t lines[kTaps * kLine * kChannels];
  LateStore store(run);
  for (int y = first; y < last; ++y) {
    for (int start = from; start < to; start += kRun) {
      const int end = std::min(start + kRun, to);
      for (int v = 0; v < kTaps; ++v) {
        RoundLine(run.input,
                  run.input.row<float>(0, y * run.stride + v - 1) + start * run.stride - 1,
                  (end - start - 1) * run.stride + kTaps, lines + v * kLine * kChannels);
      }
      const std::uint16_t* weight = run.weight;
      for (int group = 0; group * kBFloat16Group < run.output.shape.channels; ++group) {
        const int halves = HalvesInGroup(group, run.output.shape.channels);
        for (int x = start; x < end; x += step) {
          Multiply(lines + (x - start) * run.stride * kChannels, run.stride, step, halves, weight,
                   store.next());
          store.Push(group, y, x, step);
        }
        weight += std::ptrdiff_t{kTaps} * halves * kTileNumbers;
      }
    }
  }
  store.Flush();
}

}  // namespace

ORB360_AMX void RunAmxStem(const BFloat16Convolution& run, int first, int last) {
  const int width = run.output.shape.width;
  const int whole = width / kTilePixels * kTilePixels;
  if (whole > 0) {
    ShapeTiles(kTilePixels, kPairs);
    RunColumns(run, first, last, 0, whole, kTilePixels);
  }
  if (whole < width) {
    ShapeTiles(width - whole, kPairs);
    RunColumns(run, first, last, whole, width, width - whole);
  }
  _tile_release();
}

}  // namespace orb360::nn

#else

#include "nn/base/check.h"

namespace orb360::nn {

void RunAmxStem(const BFloat16Convolution&, int, int) {
  ORB360_CHECK(false, "this processor has no AMX");
}

}  // namespace orb360::nn

#endif
