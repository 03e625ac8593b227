// The transforms of tiles for Winograd's method, for each instruction set. Included by files that
// Highway compiles for all of them.

#if defined(ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#undef ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#else
#define ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include "nn/kernels/convolution_tile-inl.h"
#include "nn/kernels/winograd_points.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {

// Transforms the inputs of a tile in a row or a column. Every coefficient is that of the product of
// (x - q) over the other points q.
template <int kStride>
HWY_INLINE void TransformInput(const V* x, V* out) {
  const D d;
  if constexpr (kStride == 1) {
    const V a = hn::Set(d, static_cast<float>(kA));
    const V b = hn::Set(d, static_cast<float>(kB));
    const V half = hn::Set(d, 0.5f);
    const V two = hn::Set(d, 2.0f);
    const V five_halves = hn::Set(d, 2.5f);  // a^2 + b^2
    const V even_a = hn::NegMulAdd(two, x[2], x[4]);
    const V odd_a = hn::NegMulAdd(two, x[1], x[3]);
    const V even_b = hn::NegMulAdd(half, x[2], x[4]);
    const V odd_b = hn::NegMulAdd(half, x[1], x[3]);
    out[0] = hn::NegMulAdd(five_halves, x[2], hn::Add(x[0], x[4]));
    out[1] = hn::MulAdd(a, odd_a, even_a);
    out[2] = hn::NegMulAdd(a, odd_a, even_a);
    out[3] = hn::MulAdd(b, odd_b, even_b);
    out[4] = hn::NegMulAdd(b, odd_b, even_b);
    out[5] = hn::NegMulAdd(five_halves, x[3], hn::Add(x[1], x[5]));
  } else {
    const V half = hn::Set(d, 0.5f);
    const V two = hn::Set(d, 2.0f);
    const V three_halves = hn::Set(d, 1.5f);
    const V five_halves = hn::Set(d, 2.5f);
    const V difference = hn::Sub(x[4], x[2]);
    out[0] = hn::NegMulAdd(three_halves, hn::Add(x[2], x[4]), hn::Add(x[0], x[6]));
    out[1] = hn::NegMulAdd(two, x[2], hn::Sub(x[6], x[4]));
    out[2] = hn::NegMulAdd(five_halves, x[4], hn::Add(x[2], x[6]));
    out[3] = hn::MulAdd(half, difference, x[6]);
    out[4] = hn::NegMulAdd(three_halves, hn::Add(x[4], x[6]), hn::Add(x[2], x[8]));
    HWY_UNROLL(4)
    for (int i = 0; i < kOut; ++i) out[kPairProducts + i] = x[2 * i + 1];
  }
}

// Transforms the sums of products of a row or a column to four outputs: output i sums point^i.
template <int kStride>
HWY_INLINE void TransformOutput(const V* in, V* out) {
  const D d;
  const V half = hn::Set(d, 0.5f);
  const V two = hn::Set(d, 2.0f);
  if constexpr (kStride == 1) {
    const V a = hn::Set(d, static_cast<float>(kA));
    const V b = hn::Set(d, static_cast<float>(kB));
    const V plus_a = hn::Add(in[1], in[2]);
    const V minus_a = hn::Mul(a, hn::Sub(in[1], in[2]));
    const V plus_b = hn::Add(in[3], in[4]);
    const V minus_b = hn::Mul(b, hn::Sub(in[3], in[4]));
    out[0] = hn::Add(in[0], hn::Add(plus_a, plus_b));
    out[1] = hn::Add(minus_a, minus_b);
    out[2] = hn::MulAdd(half, plus_a, hn::Mul(two, plus_b));
    out[3] = hn::MulAdd(half, minus_a, hn::MulAdd(two, minus_b, in[5]));
  } else {
    const V half_in = hn::Mul(half, in[1]);
    const V two_in = hn::Mul(two, in[3]);
    const V* centre = in + kPairProducts;
    out[0] = hn::Add(hn::Add(in[0], in[1]), hn::Add(in[2], hn::Add(in[3], centre[0])));
    out[1] = hn::Add(hn::Sub(half_in, in[2]), hn::Add(two_in, centre[1]));
    out[2] = hn::Add(hn::MulAdd(half, half_in, in[2]), hn::MulAdd(two, two_in, centre[2]));
    out[3] = hn::Add(hn::MulAdd(hn::Set(d, 0.25f), half_in, hn::Sub(in[4], in[2])),
                     hn::MulAdd(hn::Set(d, 4.0f), two_in, centre[3]));
  }
}

struct Tile {
  int y;
  int x;
};

// True for products that together depend on every input of a row: those at 0 and at infinity, and
// with a stride of 2 those of the centres.
template <int kStride>
constexpr bool IsChecked(int product) {
  return product == 0 || (kStride == 1 ? product == kFilters - 1 : product >= kPairProducts - 1);
}

// Transforms the inputs of one tile to `out`, where the results of a block are `stride` apart.
// Returns false if the inputs, or the results that are checked, are not all finite.
template <int kStride>
bool TransformTile(const TensorView& input, Tile tile, float* out, ptrdiff_t block_stride,
                   ptrdiff_t stride) {
  constexpr int kIn = InputsOf(kStride);
  constexpr int kProducts = ProductsOf(kStride);
  const D d;
  const int top = tile.y * kOut * kStride - 1;
  const int left = tile.x * kOut * kStride - 1;
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
      HWY_UNROLL(9)
      for (int u = 0; u < kIn; ++u) {
        V column[kIn];
        HWY_UNROLL(9)
        for (int v = 0; v < kIn; ++v) {
          column[v] = hn::LoadU(d, in + v * row_stride + u * kBlock + lane);
        }
        V transformed[kIn];
        TransformInput<kStride>(column, transformed);
        HWY_UNROLL(9)
        for (int v = 0; v < kIn; ++v) x[v * kIn + u] = transformed[v];
      }
      HWY_UNROLL(9)
      for (int v = 0; v < kIn; ++v) {
        V row[kIn];
        TransformInput<kStride>(x + v * kIn, row);
        HWY_UNROLL(9)
        for (int u = 0; u < kIn; ++u) hn::Store(row[u], d, out + (v * kIn + u) * stride + lane);
        if (!IsChecked<kStride>(v)) continue;
        V checked = row[0];
        HWY_UNROLL(9)
        for (int u = 1; u < kIn; ++u) {
          if (IsChecked<kStride>(u)) checked = hn::Add(checked, row[u]);
        }
        zero_if_finite = hn::MulAdd(checked, hn::Zero(d), zero_if_finite);
      }
    }
  }
  return hn::AllTrue(d, hn::Eq(zero_if_finite, hn::Zero(d)));
}

// Transforms the products of one tile and one block of output channels, and writes its outputs.
template <int kStride>
void StoreBlock(const WinogradConvolution& run, Tile tile, int block, const float* in,
                ptrdiff_t stride) {
  constexpr int kIn = InputsOf(kStride);
  const D d;
  const TensorView& output = run.output;
  const V slope = hn::Set(d, run.slope);
  const int y = tile.y * kOut;
  const int x = tile.x * kOut;
  const int rows = std::min(kOut, output.shape.height - y);
  const int columns = std::min(kOut, output.shape.width - x);
  for (int lane = 0; lane < kBlock; lane += kLanes) {
    V half_way[kOut * kIn];
    HWY_UNROLL(9)
    for (int u = 0; u < kIn; ++u) {
      V column[kIn];
      HWY_UNROLL(9)
      for (int v = 0; v < kIn; ++v) column[v] = hn::Load(d, in + (v * kIn + u) * stride + lane);
      V transformed[kOut];
      TransformOutput<kStride>(column, transformed);
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
      TransformOutput<kStride>(half_way + v * kIn, row);
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

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#endif  // ORB360_NN_KERNELS_WINOGRAD_TRANSFORM_INL_H_
