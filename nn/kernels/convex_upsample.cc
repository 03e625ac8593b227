#include "nn/kernels/convex_upsample.h"

#include <algorithm>
#include <cmath>

#include "nn/base/check.h"

namespace orb360::nn {

void ConvexUpsample(const TensorView& x, const TensorView& weights, const TensorView& y,
                    Padding padding, int threads) {
  for (const TensorView* tensor : {&x, &weights, &y}) {
    ORB360_CHECK(tensor->layout == Layout::kPlanar && tensor->type == DataType::kFloat);
  }
  const auto [channels, rows, columns] = x.shape;
  ORB360_CHECK(channels == 1, channels);
  ORB360_CHECK((weights.shape == Shape{kConvexUpsampleWeights, rows, columns}));
  ORB360_CHECK((y.shape == Shape{1, 2 * rows, 2 * columns}));
  FillHalo(x, padding, kConvexUpsampleHalo);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int v = 0; v < rows; ++v) {
    for (int part = 0; part < 4; ++part) {
      for (int u = 0; u < columns; ++u) {
        float largest = weights.row<float>(9 * part, v)[u];
        for (int k = 1; k < 9; ++k) {
          largest = std::max(largest, weights.row<float>(9 * part + k, v)[u]);
        }
        float sum = 0;
        float value = 0;
        for (int k = 0; k < 9; ++k) {
          const float weight = std::exp(weights.row<float>(9 * part + k, v)[u] - largest);
          sum += weight;
          value += weight * x.row<float>(0, v + k / 3 - 1)[u + k % 3 - 1];
        }
        y.row<float>(0, 2 * v + part / 2)[2 * u + part % 2] = value / sum;
      }
    }
  }
}

}  // namespace orb360::nn
