#include "nn/kernels/confidence_pool.h"

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/confidence_pool.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/even_odd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A vector has at most a cache line, so that it never reaches over the end of a tensor's row.
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

void PoolRow(const float* x, std::ptrdiff_t x_stride, const float* c, std::ptrdiff_t c_stride,
             int columns, ConfidenceRule rule, float* y, float* y_confidence) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int u = 0; u < columns; u += lanes) {
    V values[4];  // of the square, row by row
    V confidences[4];
    for (int row = 0; row < 2; ++row) {
      LoadEvenOdd(d, x + row * x_stride, u, 2 * columns, values[2 * row], values[2 * row + 1]);
      LoadEvenOdd(d, c + row * c_stride, u, 2 * columns, confidences[2 * row],
                  confidences[2 * row + 1]);
    }
    V value = values[0];
    V best = confidences[0];
    for (int k = 1; k < 4; ++k) {
      const auto is_better = hn::Gt(confidences[k], best);
      value = hn::IfThenElse(is_better, values[k], value);
      best = hn::IfThenElse(is_better, confidences[k], best);
    }
    hn::StoreU(value, d, y + u);
    const bool is_quarter = rule == ConfidenceRule::kQuarter;
    hn::StoreU(is_quarter ? hn::Mul(best, hn::Set(d, 0.25f)) : hn::Sqrt(best), d, y_confidence + u);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(PoolRow);

void ConfidencePoolRow(const TensorView& x, const TensorView& c, const TensorView& y,
                       const TensorView& y_confidence, ConfidenceRule rule, int v) {
  for (int channel = 0; channel < y.shape.channels; ++channel) {
    HWY_DYNAMIC_DISPATCH(PoolRow)
    (x.row<float>(channel, 2 * v), x.row_stride, c.row<float>(channel, 2 * v), c.row_stride,
     y.shape.width, rule, y.row<float>(channel, v), y_confidence.row<float>(channel, v));
  }
}

void ConfidencePool(const TensorView& x, const TensorView& c, const TensorView& y,
                    const TensorView& y_confidence, ConfidenceRule rule, int threads) {
  for (const TensorView* tensor : {&x, &c, &y, &y_confidence}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
  }
  const int rows = y.shape.height;
  ORB360_CHECK((x.shape == Shape{y.shape.channels, 2 * rows, 2 * y.shape.width}));
  ORB360_CHECK(c.shape == x.shape && y_confidence.shape == y.shape);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) ConfidencePoolRow(x, c, y, y_confidence, rule, v);
}

}  // namespace orb360::nn
#endif
