#include "nn/kernels/convolution_direct.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

// SSSE3 would compile the code of SSE4 again. CMakeLists.txt explains the other targets.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/convolution_direct.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/convolution_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

// Data that the tiles of a row have in common.
struct Row {
  TileSource source;
  float slope;
  int out_channels;  // that exist in this group
  ptrdiff_t out_plane;
  ptrdiff_t residual_plane;
  Layout out_layout;
  DataType out_type;
  int first_lane;  // of the first channel in its block of the output
};

// Rounds to bfloat16, to nearest and ties to even. NaN becomes a quiet NaN, so that rounding does
// not carry into its exponent.
HWY_INLINE void StoreRounded(V value, std::uint16_t* to) {
  const hn::RebindToUnsigned<D> du;
  const hn::RebindToSigned<D> di;
  const hn::Rebind<std::uint16_t, D> d16;
  const auto bits = hn::BitCast(du, value);
  const auto odd = hn::And(hn::ShiftRight<16>(bits), hn::Set(du, 1));
  const auto rounded = hn::Add(bits, hn::Add(odd, hn::Set(du, 0x7fff)));
  const auto quiet = hn::Or(bits, hn::Set(du, 0x400000));
  const auto is_nan = hn::RebindMask(du, hn::IsNaN(value));
  const auto chosen = hn::ShiftRight<16>(hn::IfThenElse(is_nan, quiet, rounded));
  hn::StoreU(hn::DemoteTo(d16, hn::BitCast(di, chosen)), d16, to);
}

// Writes the sums of some pixels, [vector][pixel][lane], to blocks of bfloat16.
HWY_NOINLINE void StoreRoundedTile(const Row& row, const float* sums, int vectors, int pixels,
                                   std::uint16_t* out) {
  constexpr int kOutBlock = BlockOf(DataType::kBFloat16);
  const D d;
  const V slope = hn::Set(d, row.slope);
  for (int v = 0; v < vectors; ++v) {
    const int channel = row.first_lane + v * kLanes;
    std::uint16_t* to = out + channel / kOutBlock * row.out_plane + channel % kOutBlock;
    const auto exists = hn::FirstN(d, std::max(0, row.out_channels - v * kLanes));
    for (int p = 0; p < pixels; ++p, sums += kLanes, to += kOutBlock) {
      StoreRounded(hn::IfThenElseZero(exists, Activate(hn::Load(d, sums), slope)), to);
    }
  }
}

// Writes the sums of some pixels, [vector][pixel][lane], to planes.
HWY_NOINLINE void StorePlanarTile(const Row& row, const float* sums, int vectors, int pixels,
                                  const float* residual, float* out) {
  const auto finish = [&](int channel, int pixel) {
    float value = sums[(channel / kLanes * pixels + pixel) * kLanes + channel % kLanes];
    if (residual != nullptr) value += residual[channel * row.residual_plane + pixel];
    out[channel * row.out_plane + pixel] = value > 0 ? value : row.slope * value;
  };
  const int channels = std::min(row.out_channels, vectors * kLanes);
  int whole_channels = 0;
  int whole_pixels = 0;
#if HWY_TARGET != HWY_SCALAR
  // Squares of 4 channels x 4 pixels are transposed in registers. The last ones may overlap, but
  // for a residual, which may be in the place of the output.
  const hn::Full128<float> d;
  const hn::Full128<double> d_pair;
  const auto slope = hn::Set(d, row.slope);
  whole_channels = channels / 4 * 4;
  const bool may_overlap = residual == nullptr && pixels >= 4;
  whole_pixels = may_overlap ? pixels : pixels / 4 * 4;
  for (int c = 0; c < whole_channels; c += 4) {
    for (int first = 0; first < whole_pixels; first += 4) {
      const int p = std::min(first, pixels - 4);
      const float* from = sums + (c / kLanes * pixels + p) * kLanes + c % kLanes;
      const auto p0 = hn::LoadU(d, from);
      const auto p1 = hn::LoadU(d, from + kLanes);
      const auto p2 = hn::LoadU(d, from + 2 * kLanes);
      const auto p3 = hn::LoadU(d, from + 3 * kLanes);
      const auto low01 = hn::BitCast(d_pair, hn::InterleaveLower(d, p0, p1));
      const auto low23 = hn::BitCast(d_pair, hn::InterleaveLower(d, p2, p3));
      const auto high01 = hn::BitCast(d_pair, hn::InterleaveUpper(d, p0, p1));
      const auto high23 = hn::BitCast(d_pair, hn::InterleaveUpper(d, p2, p3));
      const auto store = [&](int channel, auto pair) HWY_ATTR {
        auto value = hn::BitCast(d, pair);
        if (residual != nullptr) {
          value = hn::Add(value, hn::LoadU(d, residual + channel * row.residual_plane + p));
        }
        value = hn::IfThenElse(hn::Gt(value, hn::Zero(d)), value, hn::Mul(value, slope));
        hn::StoreU(value, d, out + channel * row.out_plane + p);
      };
      store(c, hn::InterleaveLower(d_pair, low01, low23));
      store(c + 1, hn::InterleaveUpper(d_pair, low01, low23));
      store(c + 2, hn::InterleaveLower(d_pair, high01, high23));
      store(c + 3, hn::InterleaveUpper(d_pair, high01, high23));
    }
  }
#endif
  for (int c = 0; c < channels; ++c) {
    for (int p = c < whole_channels ? whole_pixels : 0; p < pixels; ++p) finish(c, p);
  }
}

// Writes a tile to blocks of floats after bias, residual and activation. `residual` is null if
// there is none.
template <int kVectors, int kPixels>
HWY_INLINE void StoreTile(const Row& row, const V (&sum)[kVectors][kPixels], const float* residual,
                          float* out) {
  const D d;
  const V slope = hn::Set(d, row.slope);
  HWY_UNROLL(16)
  for (int v = 0; v < kVectors; ++v) {
    const int channel = v * kLanes;
    const ptrdiff_t lane = channel % kBlock;
    // Channels that fill up the last block are zero for any input; zero weights would not be
    // sufficient for an infinite input.
    const auto exists = hn::FirstN(d, std::max(0, row.out_channels - channel));
    HWY_UNROLL(14)
    for (int p = 0; p < kPixels; ++p) {
      V value = sum[v][p];
      if (residual != nullptr) {
        value = hn::Add(value, hn::LoadU(d, residual + channel / kBlock * row.residual_plane +
                                                p * kBlock + lane));
      }
      hn::StoreU(hn::IfThenElseZero(exists, Activate(value, slope)), d,
                 out + channel / kBlock * row.out_plane + p * kBlock + lane);
    }
  }
}

template <int kBlocks, int kPixels, int kInStep>
void ComputeTile(const Row& row, const float* in, const float* residual, void* out) {
  constexpr int kVectors = kBlocks * kVectorsPerBlock;
  V sum[kVectors][kPixels];
  SumTile<kVectors, kPixels, kInStep>(row.source, in, sum);
  if (row.out_layout == Layout::kBlocked && row.out_type == DataType::kFloat) {
    StoreTile<kVectors, kPixels>(row, sum, residual, static_cast<float*>(out));
    return;
  }
  HWY_ALIGN float sums[kVectors * kPixels * kLanes];
  HWY_UNROLL(16)
  for (int v = 0; v < kVectors; ++v) {
    HWY_UNROLL(14)
    for (int p = 0; p < kPixels; ++p) hn::Store(sum[v][p], D(), sums + (v * kPixels + p) * kLanes);
  }
  if (row.out_type == DataType::kBFloat16) {
    StoreRoundedTile(row, sums, kVectors, kPixels, static_cast<std::uint16_t*>(out));
  } else {
    StorePlanarTile(row, sums, kVectors, kPixels, residual, static_cast<float*>(out));
  }
}

using TileFunction = void (*)(const Row&, const float*, const float*, void*);

// A table of the functions for tiles of 1, 2, ... pixels.
template <int kBlocks, int kInStep, int... kIndex>
const TileFunction* TileFunctions(std::integer_sequence<int, kIndex...>) {
  static constexpr TileFunction kFunctions[] = {&ComputeTile<kBlocks, kIndex + 1, kInStep>...};
  return kFunctions;
}

template <int kBlocks>
const TileFunction* TileFunctions(int in_step) {
  constexpr auto kSizes = std::make_integer_sequence<int, MaxPixels(kBlocks)>();
  switch (in_step) {
    case 1:
      return TileFunctions<kBlocks, 1>(kSizes);
    case 2:
      return TileFunctions<kBlocks, 2>(kSizes);
    case kBlock:
      return TileFunctions<kBlocks, kBlock>(kSizes);
    default:
      return TileFunctions<kBlocks, 2 * kBlock>(kSizes);
  }
}

const TileFunction* TileFunctions(int blocks, int in_step) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  if (blocks == 2) return TileFunctions<2>(in_step);
  if (blocks == 3) return TileFunctions<3>(in_step);
#endif
  return blocks == 1 ? TileFunctions<1>(in_step) : nullptr;
}

int PreferredBlocks() { return kMaxBlocks; }

// Prefetches what the window of a tile of `pixels` pixels adds to that of the tile above it, where
// every channel is a plane of its own: so many streams are more than the processor follows by
// itself. `in` is the first tap of the first pixel.
void PrefetchPlanes(const DirectConvolution& run, const float* in, int pixels) {
  constexpr int kLine = kAlignment / static_cast<int>(sizeof(float));
  const int columns = (pixels - 1) * run.stride + run.kernel;
  for (int plane = 0; plane < run.input.planes(); ++plane) {
    for (int v = std::max(0, run.kernel - run.stride); v < run.kernel; ++v) {
      const float* row = in + plane * run.input.plane_stride + v * run.input.row_stride;
      for (int x = 0; x < columns; x += kLine) hwy::Prefetch(row + x);
      hwy::Prefetch(row + columns - 1);
    }
  }
}

void RunDirectPart(const DirectConvolution& run, const Rectangle& part) {
  const TensorView& output = run.output;
  const int in_block = run.input.layout == Layout::kBlocked ? kBlock : 1;
  const int out_block = output.layout == Layout::kBlocked ? BlockOf(output.type) : 1;
  const auto out_pixel_bytes = static_cast<ptrdiff_t>(SizeOf(output.type)) * out_block;
  const int reach = run.kernel / 2;
  constexpr ptrdiff_t kNear = (ptrdiff_t{1} << 20) / ptrdiff_t{sizeof(float)};  // 1 MiB
  const bool is_far = run.input.planes() * run.input.plane_stride > kNear;
  const float* weight = run.weight;
  const float* bias = run.bias;
  int first_block = 0;
  for (const int blocks : *run.groups) {
    const TileFunction* functions = TileFunctions(blocks, run.stride * in_block);
    const int first_channel = first_block * kBlock;
    const int plane = first_channel / out_block;
    const Row row{{run.kernel, run.input.shape.channels, run.input.row_stride,
                   run.input.plane_stride, weight, bias, is_far},
                  run.slope,
                  std::min(blocks * kBlock, output.shape.channels - first_channel),
                  output.plane_stride,
                  run.residual.plane_stride,
                  output.layout,
                  output.type,
                  first_channel % out_block};
    // Tiles have equal width up to one pixel. A remainder of few pixels would have too few sums in
    // flight.
    const int width = part.right - part.left;
    const int max_pixels = MaxPixels(blocks);
    const int tiles = (width + max_pixels - 1) / max_pixels;
    for (int y = part.top; y < part.bottom; ++y) {
      const float* in = run.input.row<float>(0, y * run.stride - reach);
      std::byte* out = static_cast<std::byte*>(output.data) +
                       (plane * output.plane_stride + y * output.row_stride) *
                           static_cast<ptrdiff_t>(SizeOf(output.type));
      for (int t = 0; t < tiles; ++t) {
        const int x = part.left + t * width / tiles;
        const int end = part.left + (t + 1) * width / tiles;
        if (is_far && in_block == 1 && t + 1 < tiles) {
          const int next_end = part.left + (t + 2) * width / tiles;
          PrefetchPlanes(run, in + (end * run.stride - reach), next_end - end);
        }
        functions[end - x - 1](row, in + (x * run.stride - reach) * in_block,
                               run.residual.data == nullptr
                                   ? nullptr
                                   : run.residual.row<float>(plane, y) + x * out_block,
                               out + x * out_pixel_bytes);
      }
    }
    weight += ptrdiff_t{run.kernel} * run.kernel * run.input.shape.channels * blocks * kBlock;
    bias += blocks * kBlock;
    first_block += blocks;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(PreferredBlocks);
HWY_EXPORT(RunDirectPart);

std::vector<int> DirectGroups(int out_channels) {
  int left = (out_channels + BlockOf(DataType::kFloat) - 1) / BlockOf(DataType::kFloat);
  if (HWY_DYNAMIC_DISPATCH(PreferredBlocks)() == 1) return std::vector<int>(left, 1);
  std::vector<int> groups;
  // Groups are pairs, and one of three if the number is odd, because a single block would load
  // every input for itself.
  for (; left > 0; left -= groups.back()) groups.push_back(left == 3 ? 3 : std::min(left, 2));
  return groups;
}

void RunDirect(const DirectConvolution& run, const Rectangle& part) {
  HWY_DYNAMIC_DISPATCH(RunDirectPart)(run, part);
}

}  // namespace orb360::nn
#endif
