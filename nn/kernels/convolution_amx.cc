#include "nn/kernels/convolution_bf16.h"

#if defined(__x86_64__)

#include <algorithm>
#include <cstdint>

#include <immintrin.h>

#include "nn/kernels/convolution_bf16_store.h"

#define ORB360_AMX                                            \
  __attribute__((                                             \
      target("avx512f,avx512bw,avx512vl,avx512dq,avx512bf16," \
             "amx-tile,amx-bf16")))

namespace orb360::nn {
namespace {

// There are 8 tiles of 16 rows of 64 bytes. Tiles 0 to 3 hold sums: 16 pixels x 16 output channels,
// where tile 2 a + b has the sums of inputs 4 + a and weights 6 + b. An input tile is 16 pixels x
// 32 numbers, a weight tile is 32 numbers, in pairs, x 16 output channels. A step loads four tiles
// in 8 cycles each and multiplies four times in 16 cycles each: 2 x 2 is the smallest shape in
// which the multiplications hide the loads, and no larger one fits.
constexpr int kTileRows = 16;
constexpr int kTilePixels = 2 * kTileRows;
constexpr int kTileBytes = 1024;

struct alignas(64) TileConfiguration {
  std::uint8_t palette = 1;
  std::uint8_t start_row = 0;
  std::uint8_t reserved[14] = {};
  std::uint16_t row_bytes[16] = {};
  std::uint8_t rows[16] = {};
};
static_assert(sizeof(TileConfiguration) == 64);

// Configures all tiles for `pixels` pixels of a row at once, at most kTilePixels.
ORB360_AMX void ShapeTiles(int pixels) {
  TileConfiguration tiles;
  for (int tile = 0; tile < 8; ++tile) {
    tiles.row_bytes[tile] = 64;
    tiles.rows[tile] = kTileRows;
  }
  for (const int a : {0, 1}) {
    const auto rows = static_cast<std::uint8_t>(std::clamp(pixels - a * kTileRows, 1, kTileRows));
    tiles.rows[4 + a] = tiles.rows[2 * a] = tiles.rows[2 * a + 1] = rows;
  }
  // GCC 12 assumes that only the first 8 bytes are read.
  asm volatile("" : : "r"(&tiles) : "memory");
  _tile_loadconfig(&tiles);
}

// Computes the sums of up to 16 (kInputs = 1) or 32 pixels and 16 (kHalves = 1) or 32 output
// channels. `in` is the first tap of the first pixel.
template <int kInputs, int kHalves>
ORB360_AMX void Multiply(const BFloat16Convolution& run, const std::uint16_t* in,
                         const std::uint16_t* weight, BFloat16Sums* sums) {
  constexpr std::ptrdiff_t kBlock = BlockOf(DataType::kBFloat16);
  const std::ptrdiff_t pixel_bytes = run.stride * kBlock * 2;
  const auto* next = reinterpret_cast<const std::byte*>(weight);
  _tile_zero(0);
  if constexpr (kHalves == 2) _tile_zero(1);
  if constexpr (kInputs == 2) _tile_zero(2);
  if constexpr (kInputs == 2 && kHalves == 2) _tile_zero(3);
  const int blocks = run.input.planes();
  for (int block = 0; block < blocks; ++block, in += run.input.plane_stride) {
    for (int v = 0; v < run.kernel; ++v) {
      for (int u = 0; u < run.kernel; ++u) {
        const std::uint16_t* x = in + v * run.input.row_stride + u * kBlock;
        _tile_loadd(6, next, 64);
        _tile_loadd(4, x, pixel_bytes);
        _tile_dpbf16ps(0, 4, 6);
        if constexpr (kHalves == 2) {
          _tile_loadd(7, next + kTileBytes, 64);
          _tile_dpbf16ps(1, 4, 7);
        }
        if constexpr (kInputs == 2) {
          _tile_loadd(5, x + kTileRows * run.stride * kBlock, pixel_bytes);
          _tile_dpbf16ps(2, 5, 6);
          if constexpr (kHalves == 2) _tile_dpbf16ps(3, 5, 7);
        }
        next += kHalves * kTileBytes;
      }
    }
  }
  _tile_stored(0, sums[0], 64);
  if constexpr (kHalves == 2) _tile_stored(1, sums[1], 64);
  if constexpr (kInputs == 2) _tile_stored(2, sums[0] + kTileRows * kBFloat16Half, 64);
  if constexpr (kInputs == 2 && kHalves == 2) {
    _tile_stored(3, sums[1] + kTileRows * kBFloat16Half, 64);
  }
}

// Computes pixels `from` to `to` - 1 of some rows, `step` at a time; the tiles are configured for
// that number.
ORB360_AMX void RunColumns(const BFloat16Convolution& run, int first, int last, int from, int to,
                           int step) {
  constexpr std::ptrdiff_t kBlock = BlockOf(DataType::kBFloat16);
  const int reach = run.kernel / 2;
  const auto multiply_for = [&](int halves) {
    if (step > kTileRows) return halves == 2 ? Multiply<2, 2> : Multiply<2, 1>;
    return halves == 2 ? Multiply<1, 2> : Multiply<1, 1>;
  };
  LateStore store(run);
  const std::uint16_t* weight = run.weight;
  for (int group = 0; group * kBFloat16Group < run.output.shape.channels; ++group) {
    const int halves = HalvesInGroup(group, run.output.shape.channels);
    const auto multiply = multiply_for(halves);
    for (int y = first; y < last; ++y) {
      const std::uint16_t* in = run.input.row<std::uint16_t>(0, y * run.stride - reach);
      for (int x = from; x < to; x += step) {
        multiply(run, in + (x * run.stride - reach) * kBlock, weight, store.next());
        store.Push(group, y, x, step);
      }
    }
    weight +=
        std::ptrdiff_t{run.input.planes()} * run.kernel * run.kernel * halves * kTileBytes / 2;
  }
  store.Flush();
}

}  // namespace

ORB360_AMX void RunAmx(const BFloat16Convolution& run, int first, int last) {
  const int width = run.output.shape.width;
  const int whole = width / kTilePixels * kTilePixels;
  if (whole > 0) {
    ShapeTiles(kTilePixels);
    RunColumns(run, first, last, 0, whole, kTilePixels);
  }
  if (whole < width) {
    ShapeTiles(width - whole);
    RunColumns(run, first, last, whole, width, width - whole);
  }
  _tile_release();
}

}  // namespace orb360::nn

#else

#include <orb360/nn/base/check.h>

namespace orb360::nn {

void RunAmx(const BFloat16Convolution&, int, int) {
  ORB360_CHECK(false, "this processor has no AMX");
}

}  // namespace orb360::nn

#endif
