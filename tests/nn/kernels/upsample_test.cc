#include "nn/kernels/upsample.h"

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr Shape kShapes[] = {{1, 1, 1}, {2, 3, 5}, {3, 2, 70}, {17, 5, 3}, {33, 2, 34}};

template <typename Upsample>
void ExpectUpsampled(const PlainImage& x, Layout layout, const PlainImage& expected,
                     const PlainImage& tolerance, const Upsample& upsample) {
  const FilledTensor input(x, layout, kUpsampleBilinearHalo);
  const TensorFormat format{expected.shape, layout, DataType::kFloat, 1};
  const TensorMemory one(format);
  const TensorMemory two(format);
  upsample(input.view, one.view, 1);
  upsample(input.view, two.view, 2);
  ExpectNear(one.view, expected, tolerance);
  ExpectSameBits(one.view, two.view);
}

Shape Doubled(const Shape& shape) { return {shape.channels, 2 * shape.height, 2 * shape.width}; }

TEST(UpsampleNearest, MakesASquareOfEveryPixel) {
  ForEachDispatchTarget([] {
    for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
      for (const Shape& shape : kShapes) {
        const PlainImage x = RandomImage(shape, -3.0f, 3.0f, 1);
        PlainImage expected(Doubled(shape));
        for (int c = 0; c < shape.channels; ++c) {
          for (int v = 0; v < 2 * shape.height; ++v) {
            for (int u = 0; u < 2 * shape.width; ++u) {
              expected.at(c, v, u) = x.at(c, v / 2, u / 2);
            }
          }
        }
        ExpectUpsampled(x, layout, expected, PlainImage(expected.shape), UpsampleNearest);
      }
    }
  });
}

TEST(UpsampleBilinear, SamplesBetweenTheCentresOfPixels) {
  ForEachDispatchTarget([] {
    for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
      for (const Padding padding :
           {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
        for (const Shape& shape : kShapes) {
          if (padding == Padding::kWrapCrossPole && shape.width % 2 != 0) continue;
          const PlainImage x = RandomImage(shape, -3.0f, 3.0f, 1);
          PlainImage expected(Doubled(shape));
          PlainImage tolerance(expected.shape);
          for (int c = 0; c < shape.channels; ++c) {
            for (int v = 0; v < 2 * shape.height; ++v) {
              for (int u = 0; u < 2 * shape.width; ++u) {
                const double y_at = (v + 0.5) / 2 - 0.5;
                const double x_at = (u + 0.5) / 2 - 0.5;
                const int top = static_cast<int>(std::floor(y_at));
                const int left = static_cast<int>(std::floor(x_at));
                for (int k = 0; k < 4; ++k) {
                  const int row = top + k / 2;
                  const int column = left + k % 2;
                  const double weight = (1 - std::abs(row - y_at)) * (1 - std::abs(column - x_at));
                  const double value = x.padded(padding, c, row, column);
                  expected.at(c, v, u) += weight * value;
                  tolerance.at(c, v, u) += 6 * 0x1p-24 * std::abs(weight * value);
                }
              }
            }
          }
          ExpectUpsampled(x, layout, expected, tolerance,
                          [&](const TensorView& from, const TensorView& to, int threads) {
                            UpsampleBilinear(from, to, padding, threads);
                          });
        }
      }
    }
  });
}

TEST(Upsample, RefusesWhatIsNotTwiceTheSize) {
  const TensorMemory x({{2, 3, 4}, Layout::kPlanar, DataType::kFloat, 1});
  const TensorMemory y({{2, 6, 9}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory blocked({{2, 6, 8}, Layout::kBlocked, DataType::kFloat, 0});
  EXPECT_THROW(UpsampleNearest(x.view, y.view, 1), ContractError);
  EXPECT_THROW(UpsampleBilinear(x.view, y.view, Padding::kZero, 1), ContractError);
  EXPECT_THROW(UpsampleNearest(x.view, blocked.view, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
