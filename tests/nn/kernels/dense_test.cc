#include "nn/kernels/dense.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

TEST(Dense, IsTheProductWithTheMatrixInEveryLayout) {
  ForEachDispatchTarget([] {
    for (const auto& [outputs, inputs] : {std::pair{1, 1}, {64, 160}, {3, 17}, {33, 5}}) {
      const std::vector<float> weight =
          RandomFloats(static_cast<std::size_t>(outputs) * inputs, -1.0f, 1.0f, 1);
      const std::vector<float> bias = RandomFloats(outputs, -1.0f, 1.0f, 2);
      const PlainImage x = RandomImage({inputs, 1, 1}, -3.0f, 3.0f, 3);
      PlainImage expected({outputs, 1, 1});
      PlainImage tolerance(expected.shape);
      for (int o = 0; o < outputs; ++o) {
        expected.at(o, 0, 0) = bias[o];
        double magnitude = std::abs(bias[o]);
        for (int i = 0; i < inputs; ++i) {
          const double product = static_cast<double>(weight[o * inputs + i]) * x.at(i, 0, 0);
          expected.at(o, 0, 0) += product;
          magnitude += std::abs(product);
        }
        tolerance.at(o, 0, 0) = (inputs + 1) * 0x1p-24 * magnitude;
      }
      const Dense dense(weight, bias, outputs, inputs);
      for (const Layout from : {Layout::kPlanar, Layout::kBlocked}) {
        for (const Layout to : {Layout::kPlanar, Layout::kBlocked}) {
          const FilledTensor input(x, from, 0);
          const TensorMemory y({expected.shape, to, DataType::kFloat, 1});
          dense.Run(input.view, y.view);
          ExpectNear(y.view, expected, tolerance);
        }
      }
    }
  });
}

TEST(Dense, RefusesWhatDoesNotFit) {
  const std::vector<float> weight(6);
  const std::vector<float> bias(2);
  EXPECT_THROW(Dense(weight, bias, 2, 2), ContractError);
  EXPECT_THROW(Dense(weight, weight, 2, 3), ContractError);
  const Dense dense(weight, bias, 2, 3);
  const TensorMemory x({{3, 1, 2}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory y({{2, 1, 1}, Layout::kPlanar, DataType::kFloat, 0});
  EXPECT_THROW(dense.Run(x.view, y.view), ContractError);
}

}  // namespace
}  // namespace orb360::nn
