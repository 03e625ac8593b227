#include "nn/kernels/median_log.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "nn/base/check.h"

namespace orb360::nn {
namespace {

// The lower median of what is positive in `values`, or 1 if nothing is. Positive floats are ordered
// as their bits are, so three counting passes, over 11, 11 and 10 bits from the top, find it
// exactly without copying the points.
float LowerMedian(const TensorView& values) {
  std::uint32_t prefix = 0;  // what is known of the median's bits
  std::int64_t rank = 0;     // of the median among the values with this prefix
  int known = 0;
  for (const int bits : {11, 11, 10}) {
    std::array<std::int64_t, 1 << 11> count{};
    const int shift = 32 - known - bits;
    for (int v = 0; v < values.shape.height; ++v) {
      const float* row = values.row<float>(0, v);
      for (int u = 0; u < values.shape.width; ++u) {
        if (!(row[u] > 0)) continue;
        const auto value = std::bit_cast<std::uint32_t>(row[u]);
        const bool matches = known == 0 || value >> (32 - known) == prefix;
        if (matches) ++count[(value >> shift) & ((1u << bits) - 1)];
      }
    }
    if (known == 0) {
      std::int64_t points = 0;
      for (const std::int64_t n : count) points += n;
      if (points == 0) return 1;
      rank = (points - 1) / 2;
    }
    std::uint32_t digit = 0;
    for (; rank >= count[digit]; ++digit) rank -= count[digit];
    prefix = prefix << bits | digit;
    known += bits;
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
  const auto [channels, rows, columns] = depth.shape;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) {
    const float* depths = depth.row<float>(0, v);
    const float* confidences = confidence.row<float>(0, v);
    float* values = x.row<float>(0, v);
    float* weights = c.row<float>(0, v);
    for (int u = 0; u < columns; ++u) {
      const bool is_point =
          depths[u] > 0 && depths[u] <= std::numeric_limits<float>::max() && confidences[u] > 0;
      values[u] = is_point ? depths[u] : 0;
      weights[u] = is_point ? (confidences[u] < 1 ? confidences[u] : 1) : 0;
    }
  }
  const float middle = LowerMedian(x);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) {
    float* values = x.row<float>(0, v);
    // In double precision, where no ratio of floats overflows; points are few.
    for (int u = 0; u < columns; ++u) {
      if (values[u] > 0) {
        values[u] = static_cast<float>(std::log(static_cast<double>(values[u]) / middle));
      }
    }
  }
  *median.row<float>(0, 0) = middle;
}

}  // namespace orb360::nn
