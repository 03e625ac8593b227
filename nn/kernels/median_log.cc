#include "nn/kernels/median_log.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/median_log.cc"
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

// Copies depth and confidence of points, and writes 0 elsewhere.
void SelectPoints(const float* depth, const float* confidence, int columns, float* x, float* c) {
  const D d;
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  const V largest = hn::Set(d, std::numeric_limits<float>::max());
  for (int u = 0; u < columns; u += static_cast<int>(hn::Lanes(d))) {
    const V v_depth = hn::LoadU(d, depth + u);
    const V v_confidence = hn::LoadU(d, confidence + u);
    // Comparisons with NaN are false.
    const auto is_point = hn::And(hn::And(hn::Gt(v_depth, zero), hn::Le(v_depth, largest)),
                                  hn::Gt(v_confidence, zero));
    hn::StoreU(hn::IfThenElseZero(is_point, v_depth), d, x + u);
    hn::StoreU(hn::IfThenElseZero(is_point, hn::Min(v_confidence, one)), d, c + u);
  }
}

// Calls visit(column) for every point of a row.
template <class Visit>
HWY_INLINE void ForEachPoint(const float* x, int columns, const Visit& visit) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int u = 0; u < columns; u += lanes) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Gt(hn::LoadU(d, x + u), hn::Zero(d)), bytes);
    std::uint32_t points = bytes[0] | std::uint32_t{bytes[1]} << 8;
    if (columns - u < lanes) points &= (1u << (columns - u)) - 1;
    for (; points != 0; points &= points - 1) visit(u + std::countr_zero(points));
  }
}

// Counts the points of a row whose bits above `shift + bits` are `prefix`, by the value of the
// `bits` below.
void CountDigits(const float* x, int columns, std::uint32_t prefix, int shift, int bits,
                 std::int64_t* count) {
  const std::uint32_t mask = (1u << bits) - 1;
  ForEachPoint(x, columns, [&](int u) {
    const auto value = std::bit_cast<std::uint32_t>(x[u]);
    // The shift is in 64 bits, because the first digit has no bits above it.
    if (std::uint64_t{value} >> (shift + bits) == prefix) ++count[(value >> shift) & mask];
  });
}

// Takes the logarithm in double precision, where no ratio of floats overflows.
void TakeLog(float* x, int columns, float median) {
  ForEachPoint(x, columns, [&](int u) {
    x[u] = static_cast<float>(std::log(static_cast<double>(x[u]) / median));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {

HWY_EXPORT(SelectPoints);
HWY_EXPORT(CountDigits);
HWY_EXPORT(TakeLog);

namespace {

// Returns the lower median of the positive numbers in `values`, or 1 if there are none. Positive
// floats are ordered as their bits are, so three counting passes, over 11, 11 and 10 bits from the
// top, find it exactly without copying the points.
float LowerMedian(const TensorView& values) {
  std::uint32_t prefix = 0;  // what is known of the median's bits
  std::int64_t rank = 0;     // of the median among the values with this prefix
  int shift = 32;            // bits that are not known
  for (const int bits : {11, 11, 10}) {
    std::array<std::int64_t, 1 << 11> count{};
    shift -= bits;
    for (int v = 0; v < values.shape.height; ++v) {
      HWY_DYNAMIC_DISPATCH(CountDigits)
      (values.row<float>(0, v), values.shape.width, prefix, shift, bits, count.data());
    }
    if (shift + bits == 32) {
      const std::int64_t points = std::accumulate(count.begin(), count.end(), std::int64_t{0});
      if (points == 0) return 1;
      rank = (points - 1) / 2;
    }
    std::uint32_t digit = 0;
    for (; rank >= count[digit]; ++digit) rank -= count[digit];
    prefix = prefix << bits | digit;
  }
  return std::bit_cast<float>(prefix);
}

}  // namespace

void MedianLog(const TensorView& depth, const TensorView& confidence, const TensorView& x,
               const TensorView& c, const TensorView& median, int threads) {
  for (const TensorView* tensor : {&depth, &confidence, &x, &c}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
    ORB360_CHECK(tensor->shape == depth.shape && tensor->shape.channels == 1);
  }
  ORB360_CHECK(median.type == DataType::kFloat && median.layout == Layout::kPlanar);
  ORB360_CHECK((median.shape == Shape{1, 1, 1}));
  const int rows = depth.shape.height;
  const int columns = depth.shape.width;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) {
    HWY_DYNAMIC_DISPATCH(SelectPoints)
    (depth.row<float>(0, v), confidence.row<float>(0, v), columns, x.row<float>(0, v),
     c.row<float>(0, v));
  }
  const float middle = LowerMedian(x);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) HWY_DYNAMIC_DISPATCH(TakeLog)(x.row<float>(0, v), columns, middle);
  *median.row<float>(0, 0) = middle;
}

}  // namespace orb360::nn
#endif
