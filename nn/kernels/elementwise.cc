#include "nn/kernels/elementwise.h"

#include <cmath>

#include "nn/base/check.h"

namespace orb360::nn {
namespace {

template <typename Function>
void ForEach(const TensorView& a, const TensorView& b, const TensorView& y, int threads,
             Function function) {
  for (const TensorView* tensor : {&a, &b, &y}) {
    ORB360_CHECK(tensor->type == DataType::kFloat && tensor->layout == y.layout);
    ORB360_CHECK(tensor->shape == y.shape);
  }
  const int step = y.layout == Layout::kBlocked ? BlockOf(y.type) : 1;
  const int rows = y.shape.height;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < y.planes() * rows; ++line) {
    const int plane = line / rows;
    const float* first = a.row<float>(plane, line % rows);
    const float* second = b.row<float>(plane, line % rows);
    float* to = y.row<float>(plane, line % rows);
    for (int i = 0; i < y.shape.width * step; ++i) {
      to[i] = plane * step + i % step < y.shape.channels ? function(first[i], second[i]) : 0;
    }
  }
}

template <typename Function>
void ForEach(const TensorView& x, const TensorView& y, int threads, Function function) {
  ForEach(x, x, y, threads, [&](float value, float) { return function(value); });
}

}  // namespace

void Relu(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) { return value < 0 ? 0 : value; });
}

void LeakyRelu(const TensorView& x, float slope, const TensorView& y, int threads) {
  ForEach(x, y, threads, [&](float value) { return value < 0 ? slope * value : value; });
}

void Tanh(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) { return std::tanh(value); });
}

void Sigmoid(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) { return 1 / (1 + std::exp(-value)); });
}

void Softplus(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) {
    return std::isnan(value) ? value
                             : std::fmax(value, 0.0f) + std::log1p(std::exp(-std::fabs(value)));
  });
}

void Exp(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) { return std::exp(value); });
}

void Log(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](float value) { return std::log(value); });
}

void Clamp(const TensorView& x, float minimum, float maximum, const TensorView& y, int threads) {
  ORB360_CHECK(minimum <= maximum, minimum, maximum);
  ForEach(x, y, threads, [&](float value) {
    return value < minimum ? minimum : value > maximum ? maximum : value;
  });
}

void Affine(const TensorView& x, float scale, float offset, const TensorView& y, int threads) {
  ForEach(x, y, threads, [&](float value) { return scale * value + offset; });
}

void Add(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  ForEach(a, b, y, threads, [](float first, float second) { return first + second; });
}

void Multiply(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  ForEach(a, b, y, threads, [](float first, float second) { return first * second; });
}

}  // namespace orb360::nn
