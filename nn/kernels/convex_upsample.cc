#include "nn/kernels/convex_upsample.h"

#include <algorithm>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/convex_upsample.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A vector has at most a cache line, so that it never reaches over the end of a row of the inputs.
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// The mean of `neighbour` with the nine weights at `weights`, which are one plane apart.
HWY_INLINE V Mix(const float* weights, std::ptrdiff_t plane_stride, const V (&neighbour)[9]) {
  const D d;
  V weight[9];
  for (int k = 0; k < 9; ++k) weight[k] = hn::Load(d, weights + k * plane_stride);
  V largest = weight[0];
  for (int k = 1; k < 9; ++k) largest = hn::Max(largest, weight[k]);
  V sum = hn::Zero(d);
  V value = hn::Zero(d);
  for (int k = 0; k < 9; ++k) {
    const V fraction = ExpOfWeight(d, hn::Sub(weight[k], largest));
    sum = hn::Add(sum, fraction);
    value = hn::MulAdd(fraction, neighbour[k], value);
  }
  return hn::Div(value, sum);
}

// Computes the rows of the output that belong to row v of the input: one, or two if the size is
// doubled.
void ConvexRows(const TensorView& x, const TensorView& weights, int v, bool doubles,
                const TensorView& y) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int columns = x.shape.width;
  for (int u = 0; u < columns; u += lanes) {
    V neighbour[9];
    for (int k = 0; k < 9; ++k) {
      neighbour[k] = hn::LoadU(d, x.row<float>(0, v + k / 3 - 1) + u + k % 3 - 1);
    }
    if (!doubles) {
      hn::Store(Mix(weights.row<float>(0, v) + u, weights.plane_stride, neighbour), d,
                y.row<float>(0, v) + u);
      continue;
    }
    for (int i = 0; i < 2; ++i) {
      const V left = Mix(weights.row<float>(18 * i, v) + u, weights.plane_stride, neighbour);
      const V right = Mix(weights.row<float>(18 * i + 9, v) + u, weights.plane_stride, neighbour);
      // The last two vectors of a row of the output may reach over its end.
      HWY_ALIGN float both[32];
      hn::StoreInterleaved2(left, right, d, both);
      std::copy_n(both, 2 * std::min(lanes, columns - u), y.row<float>(0, 2 * v + i) + 2 * u);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(ConvexRows);

void ConvexUpsample(const TensorView& x, const TensorView& weights, const TensorView& y, int factor,
                    Padding padding, int threads) {
  for (const TensorView* tensor : {&x, &weights, &y}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
  }
  const int rows = x.shape.height;
  const int columns = x.shape.width;
  ORB360_CHECK(x.shape.channels == 1, x.shape.channels);
  ORB360_CHECK(factor == 1 || factor == 2, factor);
  ORB360_CHECK((weights.shape == Shape{ConvexUpsampleWeights(factor), rows, columns}));
  ORB360_CHECK((y.shape == Shape{1, factor * rows, factor * columns}));
  FillHalo(x, padding, kConvexUpsampleHalo);
  const auto convex_rows = HWY_DYNAMIC_DISPATCH(ConvexRows);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) convex_rows(x, weights, v, factor == 2, y);
}

}  // namespace orb360::nn
#endif
