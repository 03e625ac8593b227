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

#include "nn/kernels/convolution_tile-inl.h"
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

struct Tile {
  int y;
  int x;
};

// Transforms the inputs of one tile to `out`, where the 36 results of a block are `stride` apart.
// Returns false if the inputs, or the results, are not all finite.
bool TransformTile(const TensorView& input, Tile tile, float* out, ptrdiff_t block_stride,
                   ptrdiff_t stride) {
  const D d;
  const int top = tile.y * kOut - 1;
  const int left = tile.x * kOut - 1;
  // Number of inputs that exist, including one pixel of padding.
  const int rows = std::min(kIn, input.shape.height + 1 - top);
  const int columns = std::min(kIn, input.shape.width + 1 - left);
  HWY_ALIGN float edge[kProducts * kBlock];
  V zero_if_finite = hn::Zero(d);
  for (int block = 0; block < input.planes(); ++block, out += block_stride) {
    const float* in = input.row<float>(block, top) + ptrdiff_t{left} * kBlock;
    ptrdiff_t row_stride = input.row_stride;
    if (rows < kIn || columns < kIn) {
      // Inputs beyond affect only outputs that do not exist; zeros keep them from being NaN.
      std::fill(std::begin(edge), std::end(edge), 0.0f);
      for (int v = 0; v < rows; ++v) {
        std::copy_n(in + v * row_stride, columns * kBlock, edge + v * kIn * kBlock);
      }
      in = edge;
      row_stride = kIn * kBlock;
    }
    for (int lane = 0; lane < kBlock; lane += kLanes) {
      V x[kProducts];
      HWY_UNROLL(6)
      for (int u = 0; u < kIn; ++u) {
        V column[kIn];
        HWY_UNROLL(6)
        for (int v = 0; v < kIn; ++v) {
          column[v] = hn::LoadU(d, in + v * row_stride + u * kBlock + lane);
        }
        V transformed[kIn];
        TransformInput<1>(column, transformed);
        HWY_UNROLL(6)
        for (int v = 0; v < kIn; ++v) x[v * kIn + u] = transformed[v];
      }
      HWY_UNROLL(6)
      for (int v = 0; v < kIn; ++v) {
        V row[kIn];
        TransformInput<1>(x + v * kIn, row);
        HWY_UNROLL(6)
        for (int u = 0; u < kIn; ++u) hn::Store(row[u], d, out + (v * kIn + u) * stride + lane);
        // The results at 0 and at infinity depend on every input: on the even ones and on the odd
        // ones.
        if (v == 0 || v == kIn - 1) {
          zero_if_finite = hn::MulAdd(hn::Add(row[0], row[kIn - 1]), hn::Zero(d), zero_if_finite);
        }
      }
    }
  }
  return hn::AllTrue(d, hn::Eq(zero_if_finite, hn::Zero(d)));
}

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

// Transforms the products of one tile and one block of output channels, and writes its outputs.
void StoreBlock(const WinogradConvolution& run, Tile tile, int block, const float* in,
                ptrdiff_t stride) {
  const D d;
  const TensorView& output = run.output;
  const V slope = hn::Set(d, run.slope);
  const int y = tile.y * kOut;
  const int x = tile.x * kOut;
  const int rows = std::min(kOut, output.shape.height - y);
  const int columns = std::min(kOut, output.shape.width - x);
  for (int lane = 0; lane < kBlock; lane += kLanes) {
    V half_way[kOut * kIn];
    HWY_UNROLL(6)
    for (int u = 0; u < kIn; ++u) {
      V column[kIn];
      HWY_UNROLL(6)
      for (int v = 0; v < kIn; ++v) column[v] = hn::Load(d, in + (v * kIn + u) * stride + lane);
      V transformed[kOut];
      TransformOutput<1, 1>(column, transformed);
      HWY_UNROLL(4)
      for (int v = 0; v < kOut; ++v) half_way[v * kIn + u] = transformed[v];
    }
    const int channel = block * kBlock + lane;
    const V bias = hn::Load(d, run.bias + channel);
    const int exist = std::clamp(output.shape.channels - channel, 0, kLanes);
    const auto exists = hn::FirstN(d, static_cast<size_t>(exist));
    HWY_UNROLL(4)
    for (int v = 0; v < kOut; ++v) {
      if (v >= rows) break;
      V row[kOut];
      TransformOutput<1, 1>(half_way + v * kIn, row);
      HWY_UNROLL(4)
      for (int u = 0; u < kOut; ++u) {
        if (u >= columns) break;
        V value = hn::Add(row[u], bias);
        if (output.layout == Layout::kBlocked) {
          const ptrdiff_t at = ptrdiff_t{x + u} * kBlock + lane;
          if (run.residual.data != nullptr) {
            value = hn::Add(value, hn::LoadU(d, run.residual.row<float>(block, y + v) + at));
          }
          // Channels that fill up the last block are zero, also if the sums are infinite.
          hn::StoreU(hn::IfThenElseZero(exists, Activate(value, slope)), d,
                     output.row<float>(block, y + v) + at);
          continue;
        }
        HWY_ALIGN float values[kLanes];
        hn::Store(value, d, values);
        for (int c = 0; c < exist; ++c) {
          float sum = values[c];
          if (run.residual.data != nullptr) {
            sum += run.residual.row<float>(channel + c, y + v)[x + u];
          }
          output.row<float>(channel + c, y + v)[x + u] = sum > 0 ? sum : run.slope * sum;
        }
      }
    }
  }
}

// Computes all products of `count` tiles for one group of output channels.
void MultiplyGroup(const WinogradConvolution& run, int blocks, const float* weight, int count,
                   const float* inputs, float* products) {
  HWY_ALIGN static constexpr float kZeros[kMaxGroup * kBlock] = {};
  const int in_channels = run.input.shape.channels;
  const ptrdiff_t plane = ptrdiff_t{count} * kBlock;
  const ptrdiff_t in_stride = ProductStride(run.input.planes(), count);
  const ptrdiff_t out_stride = ProductStride(blocks, count);
  const MultiplyFunction* functions = MultiplyFunctions(blocks);
  const int parts = (count + MaxPixels(blocks) - 1) / MaxPixels(blocks);
  for (int product = 0; product < kProducts; ++product) {
    const TileSource source{1, in_channels, 0, plane, weight, kZeros};
    for (int part = 0; part < parts; ++part) {
      const int t = part * count / parts;
      const int end = (part + 1) * count / parts;
      functions[end - t - 1](source, inputs + product * in_stride + t * kBlock,
                             products + product * out_stride + t * kBlock, plane);
    }
    weight += ptrdiff_t{in_channels} * blocks * kBlock;
  }
}

// Where the products of a batch begin in its scratch memory, behind the inputs.
float* ProductsIn(float* scratch, int in_blocks) {
  return scratch + kProducts * ProductStride(in_blocks, kMaxWinogradTiles);
}

void MultiplyTiles(const WinogradConvolution& run, int count, float* scratch) {
  const float* weight = run.weight;
  for (const int blocks : *run.groups) {
    MultiplyGroup(run, blocks, weight, count, scratch, ProductsIn(scratch, run.input.planes()));
    weight += ptrdiff_t{kProducts} * run.input.shape.channels * blocks * kBlock;
  }
}

std::uint32_t RunWinogradTiles(const WinogradConvolution& run, int first, int last,
                               float* scratch) {
  const int count = last - first;
  const int across = (run.output.shape.width + kOut - 1) / kOut;
  const int in_blocks = run.input.planes();
  const ptrdiff_t in_stride = ProductStride(in_blocks, count);
  float* const inputs = scratch;
  float* const products = ProductsIn(scratch, in_blocks);
  const ptrdiff_t plane = ptrdiff_t{count} * kBlock;
  const auto tile = [&](int t) { return Tile{(first + t) / across, (first + t) % across}; };
  std::uint32_t left_out = 0;
  for (int t = 0; t < count; ++t) {
    if (!TransformTile(run.input, tile(t), inputs + t * kBlock, plane, in_stride)) {
      left_out |= std::uint32_t{1} << t;
    }
  }
  const float* weight = run.weight;
  int first_block = 0;
  for (const int blocks : *run.groups) {
    const ptrdiff_t out_stride = ProductStride(blocks, count);
    MultiplyGroup(run, blocks, weight, count, inputs, products);
    weight += ptrdiff_t{kProducts} * run.input.shape.channels * blocks * kBlock;
    for (int block = 0; block < blocks; ++block) {
      for (int t = 0; t < count; ++t) {
        if ((left_out >> t & 1) != 0) continue;
        StoreBlock(run, tile(t), first_block + block, products + block * plane + t * kBlock,
                   out_stride);
      }
    }
    first_block += blocks;
  }
  return left_out;
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

std::size_t WinogradScratchBytes(int in_channels) {
  constexpr int kBlock = BlockOf(DataType::kFloat);
  const int in_blocks = (in_channels + kBlock - 1) / kBlock;
  return sizeof(float) * kProducts *
         static_cast<std::size_t>(ProductStride(in_blocks, kMaxWinogradTiles) +
                                  ProductStride(kMaxGroup, kMaxWinogradTiles));
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
