#include "nn/kernels/confidence_pool.h"

#include <cmath>

#include "nn/base/check.h"

namespace orb360::nn {

void ConfidencePool(const TensorView& x, const TensorView& c, const TensorView& y,
                    const TensorView& y_confidence, ConfidenceRule rule, int threads) {
  for (const TensorView* tensor : {&x, &c, &y, &y_confidence}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
  }
  const auto [channels, rows, columns] = y.shape;
  ORB360_CHECK((x.shape == Shape{channels, 2 * rows, 2 * columns}));
  ORB360_CHECK(c.shape == x.shape && y_confidence.shape == y.shape);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < channels * rows; ++line) {
    const int channel = line / rows;
    const int v = line % rows;
    for (int u = 0; u < columns; ++u) {
      float best = c.row<float>(channel, 2 * v)[2 * u];
      float value = x.row<float>(channel, 2 * v)[2 * u];
      for (int k = 1; k < 4; ++k) {
        const float candidate = c.row<float>(channel, 2 * v + k / 2)[2 * u + k % 2];
        if (candidate > best) {
          best = candidate;
          value = x.row<float>(channel, 2 * v + k / 2)[2 * u + k % 2];
        }
      }
      y.row<float>(channel, v)[u] = value;
      y_confidence.row<float>(channel, v)[u] =
          rule == ConfidenceRule::kQuarter ? best / 4 : std::sqrt(best);
    }
  }
}

}  // namespace orb360::nn
