#include "nn/kernels/upsample.h"

#include "nn/base/check.h"

namespace orb360::nn {
namespace {

// Floats from one pixel of a plane to the next; also the floats of one pixel.
int Step(const TensorView& tensor) {
  return tensor.layout == Layout::kBlocked ? BlockOf(tensor.type) : 1;
}

void CheckDoubling(const TensorView& x, const TensorView& y) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat);
  ORB360_CHECK(x.layout == y.layout);
  ORB360_CHECK((y.shape == Shape{x.shape.channels, 2 * x.shape.height, 2 * x.shape.width}));
}

}  // namespace

void UpsampleNearest(const TensorView& x, const TensorView& y, int threads) {
  CheckDoubling(x, y);
  const int step = Step(x);
  const int rows = y.shape.height;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < y.planes() * rows; ++line) {
    const float* from = x.row<float>(line / rows, line % rows / 2);
    float* to = y.row<float>(line / rows, line % rows);
    for (int u = 0; u < y.shape.width; ++u) {
      for (int i = 0; i < step; ++i) to[u * step + i] = from[u / 2 * step + i];
    }
  }
}

void UpsampleBilinear(const TensorView& x, const TensorView& y, Padding padding, int threads) {
  CheckDoubling(x, y);
  FillHalo(x, padding, kUpsampleBilinearHalo);
  const int step = Step(x);
  const int rows = y.shape.height;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < y.planes() * rows; ++line) {
    const int plane = line / rows;
    const int v = line % rows;
    // An even row lies a quarter of a pixel before its input row, an odd one behind it.
    const float* near = x.row<float>(plane, v / 2);
    const float* far = x.row<float>(plane, v % 2 == 0 ? v / 2 - 1 : v / 2 + 1);
    float* to = y.row<float>(plane, v);
    for (int u = 0; u < y.shape.width; ++u) {
      const int a = u / 2 * step;
      const int b = u % 2 == 0 ? a - step : a + step;
      for (int i = 0; i < step; ++i) {
        to[u * step + i] = 0.75f * (0.75f * near[a + i] + 0.25f * far[a + i]) +
                           0.25f * (0.75f * near[b + i] + 0.25f * far[b + i]);
      }
    }
  }
}

}  // namespace orb360::nn
