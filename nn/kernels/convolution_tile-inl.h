// The tile of a convolution that stays in registers, for each instruction set. Included by files
// that Highway compiles for all of them.

#if defined(ORB360_NN_KERNELS_CONVOLUTION_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_CONVOLUTION_TILE_INL_H_
#undef ORB360_NN_KERNELS_CONVOLUTION_TILE_INL_H_
#else
#define ORB360_NN_KERNELS_CONVOLUTION_TILE_INL_H_
#endif

#include <algorithm>
#include <atomic>
#include <cstddef>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <orb360/nn/tensor.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = BlockOf(DataType::kFloat);

// A vector holds a block of output channels, or the largest fraction of one that fits a register.
using D = hn::CappedTag<float, kBlock>;
using V = hn::Vec<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
constexpr int kVectorsPerBlock = kBlock / kLanes;
// Vectors of half a block, for a last one with few channels; 0 where a block is one vector.
constexpr int kVectorsPerHalf = kVectorsPerBlock / 2;

// The tile that stays in registers covers all output channels of a group at a few pixels of a row.
// A step handles one input channel of one tap: it loads the tile's weights, broadcasts each pixel's
// input, and adds their products.
//
// - The units finish 2 FMAs a cycle with a latency of 4 cycles (Intel since Skylake, AMD since Zen;
//   4 units x 4 cycles on the widest ARM cores): 8 sums must be on their way, 16 there.
// - They load 2 vectors a cycle: a tile of b vectors x p pixels loads b + p of them for b * p FMAs,
//   and keeps up if b + p <= b * p.
// - All sums, the b weights and one input fit the registers.
//
// AVX-512 has 32 registers: 2 x 14 takes 31 of them, loads 16 times in 14 cycles and needs 128
// bytes of weights in that time, which the second-level cache delivers; 3 x 9 does the same for an
// odd number of blocks. A single block loads as often as it multiplies, with 14 pixels or with 28.
// AVX2 has 16 registers: 2 x 6 takes 15. SSE4, without FMA, needs one more for the product: 4 x 2
// takes 8 + 4 + 2. NEON has 32 registers: 4 x 6 takes 29.
// Half a block has twice the pixels.
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
constexpr int kMaxBlocks = 3;
constexpr int MaxPixels(int blocks) { return blocks == 3 ? 9 : 14; }
#elif HWY_TARGET == HWY_AVX2 || HWY_ARCH_ARM_A64
constexpr int kMaxBlocks = 1;
constexpr int MaxPixels(int /*blocks*/) { return 6; }
#else
constexpr int kMaxBlocks = 1;
constexpr int MaxPixels(int /*blocks*/) { return 2; }
#endif

// The input of a convolution. Its planes contain blocks of channels (kBlocked) or single ones.
struct TileSource {
  int kernel;
  int in_channels;
  ptrdiff_t in_row;     // elements from a row of the input to the next
  ptrdiff_t in_plane;   // from a plane to the next
  const float* weight;  // [block of input channels][tap][input channel][output channel]
  const float* bias;
  bool is_far = false;  // not in the second-level cache
};

// Adds the products of one input channel and one tap.
template <int kInStep, int kVectors, int kPixels>
HWY_INLINE void MultiplyAdd(const float* HWY_RESTRICT x, const float* HWY_RESTRICT weight,
                            V (&sum)[kVectors][kPixels]) {
  const D d;
  V w[kVectors];
  HWY_UNROLL(16)
  for (int i = 0; i < kVectors; ++i) w[i] = hn::Load(d, weight + i * kLanes);
  HWY_UNROLL(14)
  for (int p = 0; p < kPixels; ++p) {
    const V value = hn::Set(d, x[p * kInStep]);
    HWY_UNROLL(16)
    for (int i = 0; i < kVectors; ++i) sum[i][p] = hn::MulAdd(value, w[i], sum[i][p]);
  }
}

// Computes the sums of kPixels pixels; `in` is the first tap of the first one. Weights are those of
// whole blocks, also where kVectors are half of one. `kInStep` is the distance between the inputs
// of two pixels: the stride, in blocks if the input is blocked.
template <int kVectors, int kPixels, int kInStep>
HWY_INLINE void SumTile(const TileSource& source, const float* in, V (&sum)[kVectors][kPixels]) {
  constexpr bool kIsPlanar = kInStep < kBlock;
  // Input channels per iteration; counting and branching use the FMAs' ports too. Planar inputs
  // have few channels.
  constexpr int kTurn = kIsPlanar ? 1 : 4;
  constexpr int kWeights = (kVectors * kLanes + kBlock - 1) / kBlock * kBlock;
  const D d;
  HWY_UNROLL(16)
  for (int v = 0; v < kVectors; ++v) {
    const V bias = hn::Load(d, source.bias + v * kLanes);
    HWY_UNROLL(14)
    for (int p = 0; p < kPixels; ++p) sum[v][p] = bias;
  }
  const float* HWY_RESTRICT weight = source.weight;
  const ptrdiff_t channel_step = kIsPlanar ? source.in_plane : 1;
  for (int first = 0; first < source.in_channels; first += kBlock) {
    const int count = std::min(kBlock, source.in_channels - first);
    for (int v = 0; v < source.kernel; ++v) {
      for (int u = 0; u < source.kernel; ++u) {
        const float* HWY_RESTRICT x = in + v * source.in_row + u * (kIsPlanar ? 1 : kBlock);
        if (!kIsPlanar && source.is_far && u == source.kernel - 1) {
          // The last column of taps is the first to use new pixels, those of the next tile.
          HWY_UNROLL(14)
          for (int p = 0; p < kPixels; ++p) hwy::Prefetch(x + (kPixels + p) * kInStep);
        }
        int c = 0;
        for (; c + kTurn <= count; c += kTurn) {
          HWY_UNROLL(4)
          for (int i = 0; i < kTurn; ++i) {
            MultiplyAdd<kInStep>(x + i * channel_step, weight + i * kWeights, sum);
            // This keeps the compiler from loading ahead, because no register is free.
            std::atomic_signal_fence(std::memory_order_acq_rel);
          }
          x += kTurn * channel_step;
          weight += kTurn * kWeights;
        }
        HWY_UNROLL(1)
        for (; kTurn > 1 && c < count; ++c) {
          MultiplyAdd<kInStep>(x, weight, sum);
          x += channel_step;
          weight += kWeights;
        }
      }
    }
    in += source.in_plane;
  }
}

// y = x > 0 ? x : slope * x. NaN fails the comparison and stays NaN.
HWY_INLINE V Activate(V value, V slope) {
  return hn::IfThenElse(hn::Gt(value, hn::Zero(D())), value, hn::Mul(value, slope));
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif  // ORB360_NN_KERNELS_CONVOLUTION_TILE_INL_H_
