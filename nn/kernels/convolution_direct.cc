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
#include "nn/kernels/store_planes-inl.h"

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

// Writes a tile to blocks of floats after bias, residual and activation. `residual` is null if
// there is none. The last block is filled up with zeros, as a whole one where the tile is half of
// it.
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
  if constexpr (kVectors < kVectorsPerBlock) {
    for (int p = 0; p < kPixels; ++p) {
      for (int v = kVectors; v < kVectorsPerBlock; ++v) {
        hn::StoreU(hn::Zero(d), d, out + p * kBlock + v * kLanes);
      }
    }
  }
}

template <int kVectors, int kPixels, int kInStep>
void ComputeTile(const Row& row, const float* in, const float* residual, void* out) {
  V sum[kVectors][kPixels];
  SumTile<kVectors, kPixels, kInStep>(row.source, in, sum);
  if (row.out_type == DataType::kFloat) {
    StoreTile<kVectors, kPixels>(row, sum, residual, static_cast<float*>(out));
    return;
  }
  HWY_ALIGN float sums[kVectors * kPixels * kLanes];
  HWY_UNROLL(16)
  for (int v = 0; v < kVectors; ++v) {
    HWY_UNROLL(14)
    for (int p = 0; p < kPixels; ++p) hn::Store(sum[v][p], D(), sums + (v * kPixels + p) * kLanes);
  }
  StoreRoundedTile(row, sums, kVectors, kPixels, static_cast<std::uint16_t*>(out));
}

using TileFunction = void (*)(const Row&, const float*, const float*, void*);

// A table of the functions for tiles of 1, 2, ... pixels.
template <int kVectors, int kInStep, int... kIndex>
const TileFunction* TableOf(std::integer_sequence<int, kIndex...>) {
  static constexpr TileFunction kFunctions[] = {&ComputeTile<kVectors, kIndex + 1, kInStep>...};
  return kFunctions;
}

template <int kVectors, int kMaxPixels>
const TileFunction* TableOf(int in_step) {
  constexpr auto kSizes = std::make_integer_sequence<int, kMaxPixels>();
  switch (in_step) {
    case 1:
      return TableOf<kVectors, 1>(kSizes);
    case 2:
      return TableOf<kVectors, 2>(kSizes);
    case kBlock:
      return TableOf<kVectors, kBlock>(kSizes);
    default:
      return TableOf<kVectors, 2 * kBlock>(kSizes);
  }
}

// The tiles of a group of output channels.
struct GroupTiles {
  const TileFunction* functions;  // by their pixels, from 1 on
  int max_pixels;
};

template <int kBlocks>
GroupTiles TilesOf(int in_step) {
  constexpr int kPixels = MaxPixels(kBlocks);
  return {TableOf<kBlocks * kVectorsPerBlock, kPixels>(in_step), kPixels};
}

// `channels`: that exist in the group. Half a block is enough for few, but blocks of bfloat16 have
// twice the channels.
GroupTiles ChooseTiles(int blocks, int channels, DataType out_type, int in_step) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  if (blocks == 2) return TilesOf<2>(in_step);
  if (blocks == 3) return TilesOf<3>(in_step);
#endif
  if constexpr (kVectorsPerHalf > 0) {
    if (blocks == 1 && channels <= kVectorsPerHalf * kLanes && out_type == DataType::kFloat) {
      constexpr int kPixels = 2 * MaxPixels(1);
      return {TableOf<kVectorsPerHalf, kPixels>(in_step), kPixels};
    }
  }
  return TilesOf<1>(in_step);
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

// Computes the output channels of one group in some rows. `first_block`: that of the group.
void RunGroup(const DirectConvolution& run, const Rectangle& part, int blocks, int first_block,
              const float* weight, const float* bias) {
  const TensorView& output = run.output;
  const int in_block = run.input.layout == Layout::kBlocked ? kBlock : 1;
  const int out_block = output.layout == Layout::kBlocked ? BlockOf(output.type) : 1;
  const auto out_pixel_bytes = static_cast<ptrdiff_t>(SizeOf(output.type)) * out_block;
  const int reach = run.kernel / 2;
  constexpr ptrdiff_t kNear = (ptrdiff_t{1} << 20) / ptrdiff_t{sizeof(float)};  // 1 MiB
  const bool is_far = run.input.planes() * run.input.plane_stride > kNear;
  const int first_channel = first_block * kBlock;
  const int channels = std::min(blocks * kBlock, output.shape.channels - first_channel);
  const auto [functions, max_pixels] =
      ChooseTiles(blocks, channels, output.type, run.stride * in_block);
  const int plane = first_channel / out_block;
  const Row row{{run.kernel, run.input.shape.channels, run.input.row_stride, run.input.plane_stride,
                 weight, bias, is_far},
                run.slope,
                channels,
                output.plane_stride,
                run.residual.plane_stride,
                output.type,
                first_channel % out_block};
  // Planes are written from strips, which are tensors of blocks without activation.
  const bool is_planar = output.layout == Layout::kPlanar;
  HWY_ALIGN float strip[kMaxBlocks * kStripPixels * kBlock];
  Row strip_row = row;
  strip_row.slope = 1;
  strip_row.out_plane = ptrdiff_t{kStripPixels} * kBlock;
  // Tiles have equal width up to one pixel. A remainder of few pixels would have too few sums in
  // flight.
  const int width = part.right - part.left;
  const int tiles = (width + max_pixels - 1) / max_pixels;
  for (int y = part.top; y < part.bottom; ++y) {
    const float* in = run.input.row<float>(0, y * run.stride - reach);
    std::byte* out = static_cast<std::byte*>(output.data) +
                     (plane * output.plane_stride + y * output.row_stride) *
                         static_cast<ptrdiff_t>(SizeOf(output.type));
    const auto residual_at = [&](int x) {
      return run.residual.data == nullptr ? nullptr
                                          : run.residual.row<float>(plane, y) + x * out_block;
    };
    int strip_left = part.left;
    for (int t = 0; t < tiles; ++t) {
      const int x = part.left + t * width / tiles;
      const int end = part.left + (t + 1) * width / tiles;
      if (is_far && in_block == 1 && t + 1 < tiles) {
        const int next_end = part.left + (t + 2) * width / tiles;
        PrefetchPlanes(run, in + (end * run.stride - reach), next_end - end);
      }
      const TileFunction function = functions[end - x - 1];
      const float* window = in + (x * run.stride - reach) * in_block;
      if (!is_planar) {
        function(row, window, residual_at(x), out + x * out_pixel_bytes);
        continue;
      }
      function(strip_row, window, nullptr, strip + (x - strip_left) * kBlock);
      if (t + 1 < tiles && end - strip_left + max_pixels <= kStripPixels) continue;
      StorePlanes(strip, end - strip_left,
                  {channels, reinterpret_cast<float*>(out) + strip_left, row.out_plane,
                   residual_at(strip_left), row.residual_plane, run.slope});
      strip_left = end;
    }
  }
}

void RunDirectPart(const DirectConvolution& run, const Rectangle& part) {
  const ptrdiff_t weights = ptrdiff_t{run.kernel} * run.kernel * run.input.shape.channels * kBlock;
  int first_block = 0;
  for (const int blocks : *run.groups) {
    RunGroup(run, part, blocks, first_block, run.weight + first_block * weights,
             run.bias + first_block * kBlock);
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
