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

#ifndef ORB360_NN_KERNELS_CONVOLUTION_WINOGRAD_CC_
#define ORB360_NN_KERNELS_CONVOLUTION_WINOGRAD_CC_

namespace orb360::nn {

constexpr int kOut = 4;            // outputs of a tile in a row
constexpr int kIn = kOut + 3 - 1;  // inputs of a tile in a row
constexpr int kProducts = kIn * kIn;
constexpr int kMaxGroup = 3;  // blocks of output channels

// Polynomials of degree 5 are evaluated at 0, a, -a, b, -b and infinity, where a = 1/sqrt(2) and b
// = sqrt(2). Since a b = 1 the numbers stay small, and the error is several times smaller than with
// the usual 1 and 2.
constexpr double kA = 0.70710678118654752440;
constexpr double kB = 2 * kA;

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

// Transforms six inputs, `step` apart. Every coefficient is that of the product of (x - q) over the
// other points q.
template <int kStep>
HWY_INLINE void TransformInput(const V* in, V* out) {
  const D d;
  const V a = hn::Set(d, static_cast<float>(kA));
  const V b = hn::Set(d, static_cast<float>(kB));
  const V half = hn::Set(d, 0.5f);
  const V two = hn::Set(d, 2.0f);
  const V five_halves = hn::Set(d, 2.5f);  // a^2 + b^2
  const V x0 = in[0], x1 = in[kStep], x2 = in[2 * kStep], x3 = in[3 * kStep], x4 = in[4 * kStep],
          x5 = in[5 * kStep];
  const V even_a = hn::NegMulAdd(two, x2, x4);
  const V odd_a = hn::NegMulAdd(two, x1, x3);
  const V even_b = hn::NegMulAdd(half, x2, x4);
  const V odd_b = hn::NegMulAdd(half, x1, x3);
  out[0] = hn::NegMulAdd(five_halves, x2, hn::Add(x0, x4));
  out[kStep] = hn::MulAdd(a, odd_a, even_a);
  out[2 * kStep] = hn::NegMulAdd(a, odd_a, even_a);
  out[3 * kStep] = hn::MulAdd(b, odd_b, even_b);
  out[4 * kStep] = hn::NegMulAdd(b, odd_b, even_b);
  out[5 * kStep] = hn::NegMulAdd(five_halves, x3, hn::Add(x1, x5));
}

// Transforms six sums of products, `step` apart, to four outputs: output i sums point^i.
template <int kInStep, int kOutStep>
HWY_INLINE void TransformOutput(const V* in, V* out) {
  const D d;
  const V a = hn::Set(d, static_cast<float>(kA));
  const V b = hn::Set(d, static_cast<float>(kB));
  const V plus_a = hn::Add(in[kInStep], in[2 * kInStep]);
  const V minus_a = hn::Mul(a, hn::Sub(in[kInStep], in[2 * kInStep]));
  const V plus_b = hn::Add(in[3 * kInStep], in[4 * kInStep]);
  const V minus_b = hn::Mul(b, hn::Sub(in[3 * kInStep], in[4 * kInStep]));
  const V half = hn::Set(d, 0.5f);
  const V two = hn::Set(d, 2.0f);
  out[0] = hn::Add(in[0], hn::Add(plus_a, plus_b));
  out[kOutStep] = hn::Add(minus_a, minus_b);
  out[2 * kOutStep] = hn::MulAdd(half, plus_a, hn::Mul(two, plus_b));
  out[3 * kOutStep] = hn::MulAdd(half, minus_a, hn::MulAdd(two, minus_b, in[5 * kInStep]));
}

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

AlignedVector<float> PackWinograd(std::span<const float> weight, int out_channels, int in_channels,
                                  const std::vector<int>& groups) {
  constexpr int kBlock = BlockOf(DataType::kFloat);
  // Powers 0, 1, 2 of the points, over the product of their differences from the other points.
  const double transform[kIn][3] = {{1, 0, 0},
                                    {-1 / 1.5, -kA / 1.5, -0.5 / 1.5},
                                    {-1 / 1.5, kA / 1.5, -0.5 / 1.5},
                                    {1 / 6.0, kB / 6, 2 / 6.0},
                                    {1 / 6.0, -kB / 6, 2 / 6.0},
                                    {0, 0, 1}};
  int blocks_before = 0;
  std::size_t size = 0;
  for (const int blocks : groups) size += static_cast<std::size_t>(blocks) * kBlock;
  AlignedVector<float> packed(size * kProducts * in_channels);
  float* group = packed.data();
  for (const int blocks : groups) {
    const int width = blocks * kBlock;
    // The products of one input channel. They are gathered first, because rows of the whole array
    // are too far apart for a cache.
    std::vector<float> products(static_cast<std::size_t>(kProducts) * width);
    for (int i = 0; i < in_channels; ++i) {
      for (int o = 0; o < width && blocks_before * kBlock + o < out_channels; ++o) {
        const float* filter =
            weight.data() +
            (static_cast<std::size_t>(blocks_before * kBlock + o) * in_channels + i) * 9;
        double rows[kIn][3];
        for (int p = 0; p < kIn; ++p) {
          for (int u = 0; u < 3; ++u) {
            rows[p][u] = transform[p][0] * filter[u] + transform[p][1] * filter[3 + u] +
                         transform[p][2] * filter[6 + u];
          }
        }
        for (int product = 0; product < kProducts; ++product) {
          const double* row = rows[product / kIn];
          const double* column = transform[product % kIn];
          products[product * width + o] =
              static_cast<float>(row[0] * column[0] + row[1] * column[1] + row[2] * column[2]);
        }
      }
      for (int product = 0; product < kProducts; ++product) {
        std::copy_n(products.data() + product * width, width,
                    group + (static_cast<std::ptrdiff_t>(product) * in_channels + i) * width);
      }
    }
    group += static_cast<std::ptrdiff_t>(kProducts) * in_channels * width;
    blocks_before += blocks;
  }
  return packed;
}

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
