#include "nn/kernels/convex_upsample.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

TensorFormat Planar(const Shape& shape) { return {shape, Layout::kPlanar, DataType::kFloat, 0}; }

TEST(ConvexUpsample, MixesTheNeighboursByTheSoftmaxOfTheWeights) {
  ForEachDispatchTarget([] {
    for (const Padding padding :
         {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
      for (const auto& [rows, columns] : {std::pair{1, 1}, {3, 2}, {2, 17}, {5, 70}}) {
        if (padding == Padding::kWrapCrossPole && columns % 2 != 0) continue;
        const PlainImage x = RandomImage({1, rows, columns}, -3.0f, 3.0f, 1);
        // Large enough that e^weight alone would overflow.
        const PlainImage w =
            RandomImage({kConvexUpsampleWeights, rows, columns}, -120.0f, 120.0f, 2);
        PlainImage expected({1, 2 * rows, 2 * columns});
        PlainImage tolerance(expected.shape);
        for (int v = 0; v < 2 * rows; ++v) {
          for (int u = 0; u < 2 * columns; ++u) {
            const int first = 9 * (2 * (v % 2) + u % 2);
            double sum = 0;
            for (int k = 0; k < 9; ++k) sum += std::exp(w.at(first + k, v / 2, u / 2));
            for (int k = 0; k < 9; ++k) {
              const double fraction = std::exp(w.at(first + k, v / 2, u / 2)) / sum;
              const double value = x.padded(padding, 0, v / 2 + k / 3 - 1, u / 2 + k % 3 - 1);
              expected.at(0, v, u) += fraction * value;
              // Exp is good to 2 units in the last place, twice, after a difference of up to 240
              // that is rounded to 2^-17 of it.
              tolerance.at(0, v, u) +=
                  (30 * 0x1p-24 + 240 * 0x1p-24) * fraction * (std::abs(value) + 3);
            }
          }
        }
        const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
        const FilledTensor weights(w, Layout::kPlanar, 0);
        const TensorMemory one(Planar(expected.shape));
        const TensorMemory two(Planar(expected.shape));
        ConvexUpsample(input.view, weights.view, one.view, padding, 1);
        ConvexUpsample(input.view, weights.view, two.view, padding, 2);
        ExpectNear(one.view, expected, tolerance);
        ExpectSameBits(one.view, two.view);
      }
    }
  });
}

TEST(ConvexUpsample, SpreadsWhatIsNotANumberInTheWeightsToItsOutputPixelOnly) {
  ForEachDispatchTarget([] {
    const PlainImage x = RandomImage({1, 3, 20}, -3.0f, 3.0f, 1);
    PlainImage w({kConvexUpsampleWeights, 3, 20});
    w.at(9 * 2 + 4, 1, 5) = std::numeric_limits<double>::quiet_NaN();
    const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
    const FilledTensor weights(w, Layout::kPlanar, 0);
    const TensorMemory y(Planar({1, 6, 40}));
    ConvexUpsample(input.view, weights.view, y.view, Padding::kWrapReplicate, 1);
    for (int v = 0; v < 6; ++v) {
      for (int u = 0; u < 40; ++u) {
        EXPECT_EQ(std::isnan(At(y.view, 0, v, u)), v == 3 && u == 10) << v << ' ' << u;
      }
    }
  });
}

TEST(ConvexUpsample, RefusesShapesThatDoNotFit) {
  const TensorMemory x({{1, 3, 4}, Layout::kPlanar, DataType::kFloat, kConvexUpsampleHalo});
  const TensorMemory weights(Planar({kConvexUpsampleWeights, 3, 4}));
  const TensorMemory few(Planar({9, 3, 4}));
  const TensorMemory y(Planar({1, 6, 8}));
  EXPECT_THROW(ConvexUpsample(x.view, few.view, y.view, Padding::kZero, 1), ContractError);
  EXPECT_THROW(ConvexUpsample(x.view, weights.view, x.view, Padding::kZero, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
