#include "nn/kernels/latitude_sine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <orb360/nn/base/check.h>

namespace orb360::nn {

void LatitudeSine(const TensorView& y) {
  ORB360_CHECK(y.type == DataType::kFloat && y.shape.channels == 1);
  const int step = y.layout == Layout::kBlocked ? BlockOf(y.type) : 1;
  for (int v = 0; v < y.shape.height; ++v) {
    // This is the cosine of the angle from the north pole.
    const auto sine = static_cast<float>(std::cos(std::numbers::pi * (v + 0.5) / y.shape.height));
    float* row = y.row<float>(0, v);
    if (step == 1) {
      std::fill_n(row, y.shape.width, sine);
      continue;
    }
    std::fill_n(row, y.shape.width * step, 0.0f);
    for (int u = 0; u < y.shape.width; ++u) row[u * step] = sine;
  }
}

}  // namespace orb360::nn
