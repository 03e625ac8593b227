#include "nn/kernels/convolution_winograd.h"

#include <algorithm>
#include <cstdint>
#include <utility>

// As in convolution_direct.cc.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/convolution_winograd.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/winograd_transform-inl.h"

#ifndef ORB360_NN_KERNELS_CONVOLUTION_WINOGRAD_CC_
#define ORB360_NN_KERNELS_CONVOLUTION_WINOGRAD_CC_

namespace orb360::nn {

constexpr int kMaxGroup = 3;  // blocks of output channels

// Elements between the numbers of one product and the next: one block more than there are, because
// powers of two would all map to the same few lines of the cache.
constexpr std::ptrdiff_t ProductStride(int blocks, int tiles) {
  return (std::ptrdiff_t{blocks} * tiles + 1) * BlockOf(DataType::kFloat);
}

}  // namespace orb360::nn

#endif

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

// Computes the sums over input channels of one product for kCount tiles.
template <int kBlocks, int kCount>
void Multiply(const TileSource& source, const float* in, float* out, ptrdiff_t out_plane) {
  constexpr int kVectors = kBlocks * kVectorsPerBlock;
  V sum[kVectors][kCount];
  SumTile<kVectors, kCount, kBlock>(source, in, sum);
  const D d;
  HWY_UNROLL(16)
  for (int v = 0; v < kVectors; ++v) {
    float* to = out + v * kLanes / kBlock * out_plane + v * kLanes % kBlock;
    HWY_UNROLL(14)
    for (int p = 0; p < kCount; ++p) hn::Store(sum[v][p], d, to + p * kBlock);
  }
}

using MultiplyFunction = void (*)(const TileSource&, const float*, float*, ptrdiff_t);

// A table of the functions for 1, 2, ... tiles.
template <int kBlocks, int... kIndex>
const MultiplyFunction* MultiplyFunctions(std::integer_sequence<int, kIndex...>) {
  static constexpr MultiplyFunction kFunctions[] = {&Multiply<kBlocks, kIndex + 1>...};
  return kFunctions;
}

template <int kBlocks>
const MultiplyFunction* MultiplyFunctions() {
  return MultiplyFunctions<kBlocks>(std::make_integer_sequence<int, MaxPixels(kBlocks)>());
}

const MultiplyFunction* MultiplyFunctions(int blocks) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  if (blocks == 2) return MultiplyFunctions<2>();
  if (blocks == 3) return MultiplyFunctions<3>();
#endif
  return blocks == 1 ? MultiplyFunctions<1>() : nullptr;
}

// Computes all products of `count` tiles for one group of output channels.
void MultiplyGroup(const WinogradConvolution& run, int blocks, const float* weight, int count,
                   const float* inputs, float* products) {
  HWY_ALIGN static constexpr float kZeros[kMaxGroup * kBlock] = {};
  const int in_channels = run.input.shape.channels;
  const int row = InputsOf(run.stride);
  const ptrdiff_t plane = ptrdiff_t{count} * kBlock;
  const ptrdiff_t in_stride = ProductStride(run.input.planes(), count);
  const ptrdiff_t out_stride = ProductStride(blocks, count);
  const MultiplyFunction* functions = MultiplyFunctions(blocks);
  const int parts = (count + MaxPixels(blocks) - 1) / MaxPixels(blocks);
  const auto multiply = [&](const TileSource& source, int product) {
    for (int part = 0; part < parts; ++part) {
      const int t = part * count / parts;
      const int end = (part + 1) * count / parts;
      functions[end - t - 1](source, inputs + product * in_stride + t * kBlock,
                             products + product * out_stride + t * kBlock, plane);
    }
  };
  for (int filter = 0; filter < kFilters * kFilters; ++filter) {
    const TileSource source{1, in_channels, 0, plane, weight, kZeros};
    const int fv = filter / kFilters;
    const int fu = filter % kFilters;
    for (int v = fv; v < EndOfProducts(run.stride, fv); ++v) {
      for (int u = fu; u < EndOfProducts(run.stride, fu); ++u) multiply(source, v * row + u);
    }
    weight += ptrdiff_t{in_channels} * blocks * kBlock;
  }
}

// Elements of the transformed filters of a group.
ptrdiff_t FilterElements(const WinogradConvolution& run, int blocks) {
  return ptrdiff_t{kFilters * kFilters} * run.input.shape.channels * blocks * kBlock;
}

// Where the products of a batch begin in its scratch memory, behind the inputs.
float* ProductsIn(float* scratch, int in_blocks, int stride) {
  return scratch + ProductsOf(stride) * ProductStride(in_blocks, MaxWinogradTiles(stride));
}

void MultiplyTiles(const WinogradConvolution& run, int count, float* scratch) {
  float* const products = ProductsIn(scratch, run.input.planes(), run.stride);
  const float* weight = run.weight;
  for (const int blocks : *run.groups) {
    MultiplyGroup(run, blocks, weight, count, scratch, products);
    weight += FilterElements(run, blocks);
  }
}

template <int kStride>
std::uint32_t RunTiles(const WinogradConvolution& run, int first, int last, float* scratch) {
  const int count = last - first;
  const int across = (run.output.shape.width + kOut - 1) / kOut;
  const int in_blocks = run.input.planes();
  const ptrdiff_t in_stride = ProductStride(in_blocks, count);
  float* const inputs = scratch;
  float* const products = ProductsIn(scratch, in_blocks, kStride);
  const ptrdiff_t plane = ptrdiff_t{count} * kBlock;
  const auto tile = [&](int t) { return Tile{(first + t) / across, (first + t) % across}; };
  std::uint32_t left_out = 0;
  for (int t = 0; t < count; ++t) {
    if (!TransformTile<kStride>(run.input, tile(t), inputs + t * kBlock, plane, in_stride)) {
      left_out |= std::uint32_t{1} << t;
    }
  }
  const float* weight = run.weight;
  int first_block = 0;
  for (const int blocks : *run.groups) {
    const ptrdiff_t out_stride = ProductStride(blocks, count);
    MultiplyGroup(run, blocks, weight, count, inputs, products);
    weight += FilterElements(run, blocks);
    for (int block = 0; block < blocks; ++block) {
      for (int t = 0; t < count; ++t) {
        if ((left_out >> t & 1) != 0) continue;
        StoreBlock<kStride>(run, tile(t), first_block + block,
                            products + block * plane + t * kBlock, out_stride);
      }
    }
    first_block += blocks;
  }
  return left_out;
}

std::uint32_t RunWinogradTiles(const WinogradConvolution& run, int first, int last,
                               float* scratch) {
  return run.stride == 1 ? RunTiles<1>(run, first, last, scratch)
                         : RunTiles<2>(run, first, last, scratch);
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(RunWinogradTiles);
HWY_EXPORT(MultiplyTiles);

int CountWinogradTiles(const Shape& output) {
  return ((output.height + kOut - 1) / kOut) * ((output.width + kOut - 1) / kOut);
}

std::size_t WinogradScratchBytes(int in_channels, int stride) {
  static_assert(WinogradProducts(1) == ProductsOf(1) && WinogradProducts(2) == ProductsOf(2));
  constexpr int kBlock = BlockOf(DataType::kFloat);
  const int in_blocks = (in_channels + kBlock - 1) / kBlock;
  const int tiles = MaxWinogradTiles(stride);
  return sizeof(float) * ProductsOf(stride) *
         static_cast<std::size_t>(ProductStride(in_blocks, tiles) +
                                  ProductStride(kMaxGroup, tiles));
}

std::uint32_t RunWinograd(const WinogradConvolution& run, int first, int last, std::byte* scratch) {
  return HWY_DYNAMIC_DISPATCH(RunWinogradTiles)(run, first, last,
                                                reinterpret_cast<float*>(scratch));
}

void RunWinogradProducts(const WinogradConvolution& run, int count, std::byte* scratch) {
  HWY_DYNAMIC_DISPATCH(MultiplyTiles)(run, count, reinterpret_cast<float*>(scratch));
}

}  // namespace orb360::nn
#endif
