#include "nn/kernels/convolution_bf16.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/nn/kernels/convolution_case.h"

namespace orb360::nn {
namespace {

class BFloat16Convolution : public testing::Test {
 protected:
  void SetUp() override {
    if (BestBFloat16Unit() == BFloat16Unit::kNone) {
      GTEST_SKIP() << "this processor has no unit for bfloat16";
    }
  }
  // To bfloat16, and to floats in blocks and planes.
  static void ExpectRightInAllFormats(Case c) {
    c.spec.type = DataType::kBFloat16;
    ExpectRight(c);
    c.output_layout = Layout::kPlanar;
    ExpectRight(c);
    c.output_layout = Layout::kBlocked;
    c.output_type = DataType::kBFloat16;
    ExpectRight(c);
  }
};

TEST_F(BFloat16Convolution, IsThePlainSumOfRoundedNumbers) {
  for (const int kernel : {1, 3, 5}) {
    for (const int stride : {1, 2}) {
      for (const Padding padding : {Padding::kZero, Padding::kWrapReplicate}) {
        Case c{{40, 49, kernel, stride, padding, 0.1f}, 5, 38};
        ExpectRightInAllFormats(c);
        c.with_residual = true;
        ExpectRightInAllFormats(c);
      }
    }
  }
}

TEST_F(BFloat16Convolution, IsThePlainSumForEveryWidth) {
  for (int width = 1; width <= 70; ++width) {
    ExpectRightInAllFormats({{33, 38, 3, 1, Padding::kWrapReplicate, 0}, 2, width});
  }
}

TEST_F(BFloat16Convolution, IsThePlainSumForEveryNumberOfChannels) {
  for (const int in : {kMaxPlanarChannels + 1, 31, 32, 64, 80}) {
    for (const int out : {1, 16, 17, 32, 38, 64, 97}) {
      ExpectRightInAllFormats({{in, out, 3}, 2, 20});
      ExpectRightInAllFormats({{in, out, 1}, 1, 50});
    }
  }
}

TEST_F(BFloat16Convolution, TakesImagesAsFloats) {
  for (const int in : {1, 3, 6, 8, 9, kMaxPlanarChannels}) {
    for (const int out : {16, 32, 80, 97}) {
      for (const int stride : {1, 2}) {
        for (const int kernel : {1, 3, 5}) {
          Case c{{in, out, kernel, stride, Padding::kWrapReplicate, 0.1f, DataType::kBFloat16}};
          c.input_layout = Layout::kPlanar;
          c.output_type = DataType::kBFloat16;
          for (const int width : {1, 2, 31, 45, 64, 130}) {
            c.height = 3;
            c.width = width;
            ExpectRight(c);
          }
        }
      }
    }
  }
}

TEST_F(BFloat16Convolution, RoundsTheSumOfAFilterLikeOneWeight) {
  Case c{{16, 64, 3, 1, Padding::kWrapReplicate, 1, DataType::kBFloat16}, 1, 1};
  c.with_bias = false;
  Data data(c, false);
  // The same all over the window, in one channel.
  std::fill(data.input.begin(), data.input.end(), 0.0f);
  data.input[5] = 1;
  for (const BFloat16Unit unit : {BFloat16Unit::kAvx512, BFloat16Unit::kAmx}) {
    if (unit > BestBFloat16Unit()) continue;
    const std::vector<float> values = Compute(c, data, 1, unit);
    for (std::size_t o = 0; o < 64; ++o) {
      const auto filter = data.weight.begin() + static_cast<std::ptrdiff_t>((o * 16 + 5) * 9);
      double largest = 0;
      for (int tap = 0; tap < 9; ++tap) largest = std::max(largest, std::abs(double{filter[tap]}));
      // Half a unit of the last weight's rounding, and some of the float sum's.
      EXPECT_NEAR(values[o], std::accumulate(filter, filter + 9, 0.0), largest * 1.01 / 256)
          << "filter " << o;
    }
  }
}

TEST_F(BFloat16Convolution, KeepsTheEndOfTheLastBlockZeroBesideInfinity) {
  for (const BFloat16Unit unit : {BFloat16Unit::kAvx512, BFloat16Unit::kAmx}) {
    if (unit > BestBFloat16Unit()) continue;
    Case c{{32, 20, 3, 1, Padding::kZero, 1, DataType::kBFloat16}, 3, 3};
    for (const DataType type : {DataType::kFloat, DataType::kBFloat16}) {
      c.output_type = type;
      Data data(c);
      std::fill(data.input.begin(), data.input.end(), std::numeric_limits<float>::infinity());
      const std::vector<float> values = Compute(c, data, 1, unit);
      ASSERT_EQ(values.size(), 32u * 9);
      for (std::size_t i = 0; i < 20 * 9; ++i) ASSERT_FALSE(std::isfinite(values[i])) << i;
      for (std::size_t i = 20 * 9; i < values.size(); ++i) ASSERT_EQ(values[i], 0) << i;
    }
  }
}

}  // namespace
}  // namespace orb360::nn
