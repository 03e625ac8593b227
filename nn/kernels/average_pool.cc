#include "nn/kernels/average_pool.h"

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/average_pool.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/even_odd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = BlockOf(DataType::kFloat);

template <class D, class V>
HWY_INLINE V Mean(D d, V top_left, V top_right, V bottom_left, V bottom_right) {
  const V sum = hn::Add(hn::Add(top_left, top_right), hn::Add(bottom_left, bottom_right));
  return hn::Mul(hn::Set(d, 0.25f), sum);
}

void AverageRow(const float* top, const float* bottom, bool is_blocked, int count, float* to) {
  if (is_blocked) {
    const hn::CappedTag<float, kBlock> d;
    for (int u = 0; u < count; ++u) {
      for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(d))) {
        const int left = 2 * u * kBlock + i;
        const int right = left + kBlock;
        hn::Store(Mean(d, hn::Load(d, top + left), hn::Load(d, top + right),
                       hn::Load(d, bottom + left), hn::Load(d, bottom + right)),
                  d, to + u * kBlock + i);
      }
    }
    return;
  }
  const hn::CappedTag<float, kBlock> d;
  for (int u = 0; u < count; u += static_cast<int>(hn::Lanes(d))) {
    hn::Vec<decltype(d)> top_left, top_right, bottom_left, bottom_right;
    LoadEvenOdd(d, top, u, 2 * count, top_left, top_right);
    LoadEvenOdd(d, bottom, u, 2 * count, bottom_left, bottom_right);
    hn::Store(Mean(d, top_left, top_right, bottom_left, bottom_right), d, to + u);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {
namespace {

constexpr int kBlock = BlockOf(DataType::kFloat);

// Computes the means of one plane in double precision.
void PlaneMeans(const TensorView& x, int plane, double* mean) {
  const int step = x.layout == Layout::kBlocked ? kBlock : 1;
  for (int v = 0; v < x.shape.height; ++v) {
    const float* row = x.row<float>(plane, v);
    for (int u = 0; u < x.shape.width; ++u) {
      for (int i = 0; i < step; ++i) mean[i] += row[u * step + i];
    }
  }
  for (int i = 0; i < step; ++i) mean[i] /= static_cast<double>(x.shape.height) * x.shape.width;
}

}  // namespace

HWY_EXPORT(AverageRow);

void AveragePool(const TensorView& x, const TensorView& y, int threads) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat && x.layout == y.layout);
  const int rows = y.shape.height;
  const int columns = y.shape.width;
  ORB360_CHECK((x.shape == Shape{y.shape.channels, 2 * rows, 2 * columns}));
  const auto average_row = HWY_DYNAMIC_DISPATCH(AverageRow);
  const bool is_blocked = x.layout == Layout::kBlocked;
  const int planes = y.planes();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < planes * rows; ++line) {
    const int plane = line / rows;
    const int v = line % rows;
    average_row(x.row<float>(plane, 2 * v), x.row<float>(plane, 2 * v + 1), is_blocked, columns,
                y.row<float>(plane, v));
  }
}

void GlobalAveragePool(const TensorView& x, const TensorView& y, int threads) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat);
  ORB360_CHECK((y.shape == Shape{x.shape.channels, 1, 1}));
  const int from_step = x.layout == Layout::kBlocked ? kBlock : 1;
  const int to_step = y.layout == Layout::kBlocked ? kBlock : 1;
  const int channels = y.planes() * to_step;  // with those that fill up the last block
  const int planes = x.planes();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int plane = 0; plane < planes; ++plane) {
    double mean[kBlock] = {};
    PlaneMeans(x, plane, mean);
    for (int i = 0; i < from_step && plane * from_step + i < channels; ++i) {
      const int channel = plane * from_step + i;
      y.row<float>(channel / to_step, 0)[channel % to_step] = static_cast<float>(mean[i]);
    }
  }
  for (int channel = planes * from_step; channel < channels; ++channel) {
    y.row<float>(channel / to_step, 0)[channel % to_step] = 0;
  }
}

}  // namespace orb360::nn
#endif
