#include "nn/kernels/latitude_sine.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/nn/kernels/plain_image.h"

namespace orb360::nn {
namespace {

TEST(LatitudeSine, FallsFromTheNorthPoleToTheSouthPole) {
  for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
    for (const auto& [rows, columns] : {std::pair{1, 1}, {2, 3}, {256, 5}, {7, 40}}) {
      PlainImage expected({1, rows, columns});
      PlainImage tolerance(expected.shape);
      for (int v = 0; v < rows; ++v) {
        for (int u = 0; u < columns; ++u) {
          expected.at(0, v, u) =
              std::sin(std::numbers::pi / 2 - std::numbers::pi * (v + 0.5) / rows);
          tolerance.at(0, v, u) = 1.01 * 0x1p-24 * std::abs(expected.at(0, v, u)) + 1e-16;
        }
      }
      const TensorMemory y({expected.shape, layout, DataType::kFloat, 1});
      LatitudeSine(y.view);
      ExpectNear(y.view, expected, tolerance);
    }
  }
}

}  // namespace
}  // namespace orb360::nn
