#include "nn/kernels/convex_upsample.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

TensorFormat Planar(const Shape& shape) { return {shape, Layout::kPlanar, DataType::kFloat, 0}; }

// `range`: of the weights.
void ExpectMixes(int factor, Padding padding, int rows, int columns, float range) {
  const PlainImage x = RandomImage({1, rows, columns}, -3.0f, 3.0f, 1);
  const PlainImage w =
      RandomImage({ConvexUpsampleWeights(factor), rows, columns}, -range, range, 2);
  PlainImage expected({1, factor * rows, factor * columns});
  PlainImage tolerance(expected.shape);
  for (int v = 0; v < factor * rows; ++v) {
    for (int u = 0; u < factor * columns; ++u) {
      const int y = v / factor;
      const int left = u / factor;
      const int first = 9 * (factor * (v % factor) + u % factor);
      double sum = 0;
      for (int k = 0; k < 9; ++k) sum += std::exp(w.at(first + k, y, left));
      for (int k = 0; k < 9; ++k) {
        const double fraction = std::exp(w.at(first + k, y, left)) / sum;
        const double value = x.padded(padding, 0, y + k / 3 - 1, left + k % 3 - 1);
        expected.at(0, v, u) += fraction * value;
        // Twice 4 units and 2^-23 of the exponent, and sums of nine. What is less than 2^-126 of
        // the largest counts as that.
        tolerance.at(0, v, u) +=
            (40 * 0x1p-24 + 4 * range * 0x1p-24) * fraction * (std::abs(value) + 3) + 1e-37;
      }
    }
  }
  const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
  const FilledTensor weights(w, Layout::kPlanar, 0);
  const TensorMemory one(Planar(expected.shape));
  const TensorMemory two(Planar(expected.shape));
  ConvexUpsample(input.view, weights.view, one.view, factor, padding, 1);
  ConvexUpsample(input.view, weights.view, two.view, factor, padding, 2);
  ExpectNear(one.view, expected, tolerance);
  ExpectSameBits(one.view, two.view);
}

TEST(ConvexUpsample, MixesTheNeighboursByTheSoftmaxOfTheWeights) {
  ForEachDispatchTarget([] {
    for (const Padding padding :
         {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
      for (const auto& [rows, columns] : {std::pair{1, 1}, {3, 2}, {2, 17}, {5, 70}}) {
        if (padding == Padding::kWrapCrossPole && columns % 2 != 0) continue;
        for (const int factor : {1, 2}) {
          // Alike, apart, and so large that e^weight alone would overflow.
          for (const float range : {1.0f, 20.0f, 120.0f}) {
            ExpectMixes(factor, padding, rows, columns, range);
          }
        }
      }
    }
  });
}

TEST(ConvexUpsample, SpreadsWhatIsNotANumberInTheWeightsToItsOutputPixelOnly) {
  ForEachDispatchTarget([] {
    for (const int factor : {1, 2}) {
      const PlainImage x = RandomImage({1, 3, 20}, -3.0f, 3.0f, 1);
      PlainImage w({ConvexUpsampleWeights(factor), 3, 20});
      const int part = factor == 2 ? 2 : 0;  // the lower left of four
      w.at(9 * part + 4, 1, 5) = std::numeric_limits<double>::quiet_NaN();
      const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
      const FilledTensor weights(w, Layout::kPlanar, 0);
      const TensorMemory y(Planar({1, 3 * factor, 20 * factor}));
      ConvexUpsample(input.view, weights.view, y.view, factor, Padding::kWrapReplicate, 1);
      for (int v = 0; v < 3 * factor; ++v) {
        for (int u = 0; u < 20 * factor; ++u) {
          const bool is_it = v == (factor == 2 ? 3 : 1) && u == 5 * factor;
          EXPECT_EQ(std::isnan(At(y.view, 0, v, u)), is_it) << v << ' ' << u;
        }
      }
    }
  });
}

TEST(ConvexUpsample, WeighsToTheLastPlaces) {
  ForEachDispatchTarget([] {
    constexpr int kColumns = 800;
    PlainImage x({1, 2, kColumns});
    PlainImage w({ConvexUpsampleWeights(1), 2, kColumns});
    for (int u = 0; u < kColumns; ++u) {
      x.at(0, 0, u) = 1;
      for (int k = 0; k < 9; ++k) w.at(k, 1, u) = -1e4;
      w.at(4, 1, u) = 0;
      w.at(1, 1, u) = static_cast<float>(-0.1 * u);  // of the pixel above
    }
    const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
    const FilledTensor weights(w, Layout::kPlanar, 0);
    const TensorMemory y(Planar({1, 2, kColumns}));
    ConvexUpsample(input.view, weights.view, y.view, 1, Padding::kWrapReplicate, 1);
    for (int u = 0; u < kColumns; ++u) {
      const double e = std::exp(w.at(1, 1, u));
      const double expected = e / (1 + e);
      // Half a unit of the sum and of the quotient, those of the exponential, and of its exponent;
      // two neighbours of 1 with the least weight.
      const double tolerance = (10 - 2 * w.at(1, 1, u)) * 0x1p-24 * expected + 0x1p-124;
      ASSERT_NEAR(At(y.view, 0, 1, u), expected, tolerance) << w.at(1, 1, u);
    }
  });
}

TEST(ConvexUpsample, TakesNothingOfANeighbourWhoseWeightIsMinusInfinity) {
  ForEachDispatchTarget([] {
    PlainImage x({1, 3, 20});
    x.at(0, 1, 6) = 1e30;
    PlainImage w({ConvexUpsampleWeights(1), 3, 20});
    w.at(5, 1, 5) = -std::numeric_limits<double>::infinity();  // of the pixel to the right
    const FilledTensor input(x, Layout::kPlanar, kConvexUpsampleHalo);
    const FilledTensor weights(w, Layout::kPlanar, 0);
    const TensorMemory y(Planar({1, 3, 20}));
    ConvexUpsample(input.view, weights.view, y.view, 1, Padding::kWrapReplicate, 1);
    EXPECT_NEAR(At(y.view, 0, 1, 5), 0, 1e-7);
    EXPECT_GT(At(y.view, 0, 1, 7), 1e29);
  });
}

TEST(ConvexUpsample, RefusesShapesThatDoNotFit) {
  const TensorMemory x({{1, 3, 4}, Layout::kPlanar, DataType::kFloat, kConvexUpsampleHalo});
  const TensorMemory weights(Planar({ConvexUpsampleWeights(2), 3, 4}));
  const TensorMemory few(Planar({ConvexUpsampleWeights(1), 3, 4}));
  const TensorMemory y(Planar({1, 6, 8}));
  EXPECT_THROW(ConvexUpsample(x.view, few.view, y.view, 2, Padding::kZero, 1), ContractError);
  EXPECT_THROW(ConvexUpsample(x.view, weights.view, x.view, 2, Padding::kZero, 1), ContractError);
  EXPECT_THROW(ConvexUpsample(x.view, few.view, y.view, 1, Padding::kZero, 1), ContractError);
  EXPECT_THROW(ConvexUpsample(x.view, weights.view, y.view, 3, Padding::kZero, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
