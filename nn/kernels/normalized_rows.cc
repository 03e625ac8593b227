#include "nn/kernels/normalized_rows.h"

#include <algorithm>
#include <atomic>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/normalized_rows.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A vector has at most a cache line, so that it never reaches over the end of a tensor's row.
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// Computes y or y * c', and c', for one vector of columns.
HWY_INLINE void Finish(const NormalizedConvolution& layer, int o, V n, V d_sum, int u,
                       const NormalizedRow& out, bool as_products) {
  const D d;
  const V y = hn::Add(hn::Div(n, hn::Add(d_sum, hn::Set(d, 1e-20f))), hn::Set(d, layer.bias()[o]));
  const V c = hn::Mul(d_sum, hn::Set(d, layer.inverse_sum()[o]));
  hn::StoreU(as_products ? hn::Mul(y, c) : y, d, out.x + o * out.x_stride + u);
  hn::StoreU(c, d, out.c + o * out.c_stride + u);
}

// Vectors in a tile. SSE and AVX2 have 16 registers, the others 32.
constexpr int kVectors =
    HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 ? 1 : 2;

// Calls function(integral_constant) for kFirst to kEnd - 1.
template <int kFirst, int kEnd, class Function>
HWY_INLINE void ForEach(const Function& function) {
  if constexpr (kFirst < kEnd) {
    function(std::integral_constant<int, kFirst>{});
    ForEach<kFirst + 1, kEnd>(function);
  }
}

// A register tile of kRows rows of kVectors vectors and all outputs. A tap of one input costs two
// loads for each vector, most of them across two cache lines, and a broadcast weight for each row
// and output. On AVX-512, with three rows, two vectors and two outputs, these are 4 + 6 loads for
// 24 multiply-adds: 7 cycles at two loads per cycle (twice that for those across lines), hidden
// behind 12 cycles of arithmetic. 24 sums, 4 values and a weight fit 32 registers and cover the
// latency of 4 cycles at two multiply-adds per cycle. With one row the loads would take as long as
// the arithmetic.
template <int kSize, int kInputs, int kOutputs, int kRows>
HWY_INLINE void Tile(const NormalizedConvolution& layer, const NormalizedRow* in, int u,
                     int vectors, const NormalizedRow* out, bool as_products) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V n[kRows][kOutputs][kVectors];
  V sum[kRows][kOutputs][kVectors];
  for (int y = 0; y < kRows; ++y) {
    for (int o = 0; o < kOutputs; ++o) {
      for (int v = 0; v < kVectors; ++v) n[y][o][v] = sum[y][o][v] = hn::Zero(d);
    }
  }
  // Adds row r of the input to rows `first` to `last` of the output.
  const auto add = [&](auto first, auto last, int r) HWY_ATTR {
    for (int i = 0; i < kInputs; ++i) {
      const float* products = in[r].x + i * in[r].x_stride + u - kSize / 2;
      const float* confidences = in[r].c + i * in[r].c_stride + u - kSize / 2;
      const float* row_weight = layer.weight() + (r * kInputs + i) * kSize * kOutputs;
      for (int tap = 0; tap < kSize; ++tap) {
        V p[kVectors];
        V c[kVectors];
        for (int v = 0; v < kVectors; ++v) {
          p[v] = hn::LoadU(d, products + tap + v * lanes);
          c[v] = hn::LoadU(d, confidences + tap + v * lanes);
        }
        // Otherwise GCC folds every load into each of the multiply-adds that use it, which then
        // wait for loads across cache lines.
        std::atomic_signal_fence(std::memory_order_acq_rel);
        for (int y = first; y <= last; ++y) {
          for (int o = 0; o < kOutputs; ++o) {
            const V w = hn::Set(d, row_weight[(tap - y * kInputs * kSize) * kOutputs + o]);
            for (int v = 0; v < kVectors; ++v) {
              n[y][o][v] = hn::MulAdd(w, p[v], n[y][o][v]);
              sum[y][o][v] = hn::MulAdd(w, c[v], sum[y][o][v]);
            }
          }
        }
      }
    }
  };
  // Row r of the input is row r - y of the window of output y.
  ForEach<0, kSize + kRows - 1>([&](auto r) HWY_ATTR {
    using First = std::integral_constant<int, std::max(0, r - kSize + 1)>;
    using Last = std::integral_constant<int, std::min<int>(kRows - 1, r)>;
    add(First{}, Last{}, r);
  });
  for (int y = 0; y < kRows; ++y) {
    for (int o = 0; o < kOutputs; ++o) {
      for (int v = 0; v < kVectors; ++v) {
        if (v < vectors)
          Finish(layer, o, n[y][o][v], sum[y][o][v], u + v * lanes, out[y], as_products);
      }
    }
  }
}

template <int kSize, int kInputs, int kOutputs>
void FixedRows(const NormalizedConvolution& layer, const NormalizedRow* in, int rows, int width,
               const NormalizedRow* out, bool as_products) {
  const int lanes = static_cast<int>(hn::Lanes(D()));
  for (int u = 0; u < width; u += kVectors * lanes) {
    const int vectors = u + lanes < width ? kVectors : 1;
    if (rows == 3) {
      Tile<kSize, kInputs, kOutputs, 3>(layer, in, u, vectors, out, as_products);
    } else if (rows == 2) {
      Tile<kSize, kInputs, kOutputs, 2>(layer, in, u, vectors, out, as_products);
    } else {
      Tile<kSize, kInputs, kOutputs, 1>(layer, in, u, vectors, out, as_products);
    }
  }
}

// Computes rows for any number of channels and any size; sums have the order of Tile.
void AnyRows(const NormalizedConvolution& layer, const NormalizedRow* in, int rows, int width,
             const NormalizedRow* out, bool as_products) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int reach = layer.reach();
  for (int y = 0; y < rows; ++y) {
    for (int o = 0; o < layer.outputs(); ++o) {
      for (int u = 0; u < width; u += lanes) {
        V n = hn::Zero(d);
        V sum = hn::Zero(d);
        const float* weight = layer.weight() + o;
        for (int r = y; r < y + layer.size(); ++r) {
          for (int i = 0; i < layer.inputs(); ++i) {
            const float* products = in[r].x + i * in[r].x_stride + u - reach;
            const float* confidences = in[r].c + i * in[r].c_stride + u - reach;
            for (int tap = 0; tap < layer.size(); ++tap, weight += layer.outputs()) {
              const V w = hn::Set(d, *weight);
              n = hn::MulAdd(w, hn::LoadU(d, products + tap), n);
              sum = hn::MulAdd(w, hn::LoadU(d, confidences + tap), sum);
            }
          }
        }
        Finish(layer, o, n, sum, u, out[y], as_products);
      }
    }
  }
}

// The sizes of the layers of the published unguided network and of the one with seven levels are
// known at compile time.
void NormalizedRows(const NormalizedConvolution& layer, const NormalizedRow* in, int rows,
                    int width, const NormalizedRow* out, bool as_products) {
  const auto is = [&](int size, int inputs, int outputs) {
    return layer.size() == size && layer.inputs() == inputs && layer.outputs() == outputs;
  };
  if (is(5, 2, 2)) return FixedRows<5, 2, 2>(layer, in, rows, width, out, as_products);
  if (is(3, 4, 2)) return FixedRows<3, 4, 2>(layer, in, rows, width, out, as_products);
  if (is(5, 1, 2)) return FixedRows<5, 1, 2>(layer, in, rows, width, out, as_products);
  if (is(1, 2, 1)) return FixedRows<1, 2, 1>(layer, in, rows, width, out, as_products);
  AnyRows(layer, in, rows, width, out, as_products);
}

void MultiplyRow(const float* x, const float* c, int width, bool doubled, float* product,
                 float* confidence) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int count = doubled ? (width + 1) / 2 : width;
  for (int u = 0; u < count; u += lanes) {
    const V v_c = hn::LoadU(d, c + u);
    const V v_p = hn::Mul(hn::LoadU(d, x + u), v_c);
    if (doubled) {
      hn::StoreInterleaved2(v_p, v_p, d, product + 2 * u);
      hn::StoreInterleaved2(v_c, v_c, d, confidence + 2 * u);
    } else {
      hn::StoreU(v_p, d, product + u);
      hn::StoreU(v_c, d, confidence + u);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(NormalizedRows);
HWY_EXPORT(MultiplyRow);

void NormalizedRows(const NormalizedConvolution& layer, const NormalizedRow* in, int rows,
                    int width, const NormalizedRow* out, bool as_products) {
  HWY_DYNAMIC_DISPATCH(NormalizedRows)(layer, in, rows, width, out, as_products);
}

void MultiplyRow(const float* x, const float* c, int width, bool doubled, float* product,
                 float* confidence) {
  HWY_DYNAMIC_DISPATCH(MultiplyRow)(x, c, width, doubled, product, confidence);
}

}  // namespace orb360::nn
#endif
