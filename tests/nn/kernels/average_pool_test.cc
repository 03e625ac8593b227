#include "nn/kernels/average_pool.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

TEST(AveragePool, IsTheMeanOfEverySquare) {
  ForEachDispatchTarget([] {
    for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
      for (const Shape pooled : {Shape{1, 1, 1}, Shape{3, 2, 67}, Shape{17, 3, 5}}) {
        const PlainImage x =
            RandomImage({pooled.channels, 2 * pooled.height, 2 * pooled.width}, -3.0f, 3.0f, 1);
        PlainImage expected(pooled);
        PlainImage tolerance(pooled);
        for (int c = 0; c < pooled.channels; ++c) {
          for (int v = 0; v < pooled.height; ++v) {
            for (int u = 0; u < pooled.width; ++u) {
              for (int k = 0; k < 4; ++k) {
                const double value = x.at(c, 2 * v + k / 2, 2 * u + k % 2) / 4;
                expected.at(c, v, u) += value;
                tolerance.at(c, v, u) += 3 * 0x1p-24 * std::abs(value);
              }
            }
          }
        }
        const FilledTensor input(x, layout, 0);
        const TensorMemory one({pooled, layout, DataType::kFloat, 1});
        const TensorMemory two({pooled, layout, DataType::kFloat, 1});
        AveragePool(input.view, one.view, 1);
        AveragePool(input.view, two.view, 2);
        ExpectNear(one.view, expected, tolerance);
        ExpectSameBits(one.view, two.view);
      }
    }
  });
}

TEST(AveragePool, RefusesOddSizes) {
  const TensorMemory x({{1, 3, 4}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory y({{1, 1, 2}, Layout::kPlanar, DataType::kFloat, 0});
  EXPECT_THROW(AveragePool(x.view, y.view, 1), ContractError);
}

TEST(GlobalAveragePool, IsTheMeanOfEveryChannelInEveryLayout) {
  ForEachDispatchTarget([] {
    for (const Layout from : {Layout::kPlanar, Layout::kBlocked}) {
      for (const Layout to : {Layout::kPlanar, Layout::kBlocked}) {
        for (const Shape shape : {Shape{1, 1, 1}, Shape{18, 16, 33}, Shape{160, 4, 8}}) {
          const PlainImage x = RandomImage(shape, -1.0f, 3.0f, 1);
          PlainImage expected({shape.channels, 1, 1});
          PlainImage tolerance(expected.shape);
          for (int c = 0; c < shape.channels; ++c) {
            for (int v = 0; v < shape.height; ++v) {
              for (int u = 0; u < shape.width; ++u) {
                const double fraction = x.at(c, v, u) / (shape.height * shape.width);
                expected.at(c, 0, 0) += fraction;
                tolerance.at(c, 0, 0) +=
                    (shape.height * shape.width + 1) * 0x1p-24 * std::abs(fraction);
              }
            }
          }
          const FilledTensor input(x, from, 1);
          const TensorMemory one({expected.shape, to, DataType::kFloat, 0});
          const TensorMemory two({expected.shape, to, DataType::kFloat, 0});
          GlobalAveragePool(input.view, one.view, 1);
          GlobalAveragePool(input.view, two.view, 2);
          ExpectNear(one.view, expected, tolerance);
          ExpectSameBits(one.view, two.view);
        }
      }
    }
  });
}

TEST(GlobalAveragePool, KeepsWhatIsNotANumberInItsChannel) {
  PlainImage x({3, 2, 2});
  x.at(1, 1, 0) = std::numeric_limits<double>::quiet_NaN();
  const FilledTensor input(x, Layout::kBlocked, 0);
  const TensorMemory y({{3, 1, 1}, Layout::kPlanar, DataType::kFloat, 0});
  GlobalAveragePool(input.view, y.view, 1);
  EXPECT_EQ(At(y.view, 0, 0, 0), 0);
  EXPECT_TRUE(std::isnan(At(y.view, 1, 0, 0)));
  EXPECT_EQ(At(y.view, 2, 0, 0), 0);
}

}  // namespace
}  // namespace orb360::nn
