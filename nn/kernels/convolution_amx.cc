#include "nn/kernels/convolution_bf16.h"

#if defined(__x86_64__)

#include "nn/kernels/amx_tiles.h"
#include "nn/kernels/convolution_bf16_store.h"

namespace orb360::nn {
namespace {

constexpr int kTileBytes = 1024;

// The sums of up to 16 (kInputs = 1) or 32 pixels and 16 (kHalves = 1) or 32 output channels. `in`
// is the first tap of the first pixel.
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

// Pixels `from` to `to` - 1 of some rows, `step` at a time, for which the tiles are shaped.
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
    ShapeTiles(kTilePixels, 16);
    RunColumns(run, first, last, 0, whole, kTilePixels);
  }
  if (whole < width) {
    ShapeTiles(width - whole, 16);
    RunColumns(run, first, last, whole, width, width - whole);
  }
  _tile_release();
}

}  // namespace orb360::nn

#else

#include "nn/base/check.h"

namespace orb360::nn {

void RunAmx(const BFloat16Convolution&, int, int) {
  ORB360_CHECK(false, "this processor has no AMX");
}

}  // namespace orb360::nn

#endif
