#include "nn/kernels/average_pool.h"

#include "nn/base/check.h"

namespace orb360::nn {
namespace {

// Floats of one pixel of a plane.
int Step(const TensorView& tensor) {
  return tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
}

}  // namespace

void AveragePool(const TensorView& x, const TensorView& y, int threads) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat && x.layout == y.layout);
  const auto [channels, rows, columns] = y.shape;
  ORB360_CHECK((x.shape == Shape{channels, 2 * rows, 2 * columns}));
  const int step = Step(x);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < y.planes() * rows; ++line) {
    const float* top = x.row<float>(line / rows, 2 * (line % rows));
    const float* bottom = top + x.row_stride;
    float* to = y.row<float>(line / rows, line % rows);
    for (int u = 0; u < columns; ++u) {
      for (int i = 0; i < step; ++i) {
        const int a = 2 * u * step + i;
        to[u * step + i] = 0.25f * ((top[a] + top[a + step]) + (bottom[a] + bottom[a + step]));
      }
    }
  }
}

void GlobalAveragePool(const TensorView& x, const TensorView& y, int threads) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat);
  ORB360_CHECK((y.shape == Shape{x.shape.channels, 1, 1}));
  const int from_step = Step(x);
  const int to_step = Step(y);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int channel = 0; channel < y.planes() * to_step; ++channel) {
    double sum = 0;
    for (int v = 0; v < x.shape.height && channel < x.shape.channels; ++v) {
      const float* row = x.row<float>(channel / from_step, v) + channel % from_step;
      for (int u = 0; u < x.shape.width; ++u) sum += row[u * from_step];
    }
    y.row<float>(channel / to_step, 0)[channel % to_step] =
        static_cast<float>(sum / (static_cast<double>(x.shape.height) * x.shape.width));
  }
}

}  // namespace orb360::nn
