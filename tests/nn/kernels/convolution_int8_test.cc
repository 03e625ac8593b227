#include "nn/kernels/convolution_int8.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/nn/kernels/convolution_case.h"

namespace orb360::nn {
namespace {

constexpr float kZero = 37;  // the byte that means zero

// A case in which one step of the input and one of every output channel's weights is 1, so that all
// sums are integers that floats hold exactly.
Case OfIntegers(ConvolutionSpec spec, int height, int width) {
  spec.type = DataType::kInt8;
  spec.minimum = -kZero;
  spec.maximum = 255 - kZero;
  return {spec, height, width};
}

// Whole numbers; `input` reaches beyond the range by `beyond`.
Data Integers(const Case& c, float beyond) {
  Data data(c);
  std::mt19937 generator(1);
  const auto fill = [&](std::vector<float>* values, float low, float high) {
    std::uniform_int_distribution<int> uniform(static_cast<int>(low), static_cast<int>(high));
    for (float& value : *values) value = static_cast<float>(uniform(generator));
  };
  fill(&data.weight, -127, 127);
  const std::size_t filter = data.weight.size() / static_cast<std::size_t>(c.spec.out_channels);
  for (std::size_t i = 0; i < data.weight.size(); i += filter) data.weight[i] = -127;
  fill(&data.input, c.spec.minimum - beyond, c.spec.maximum + beyond);
  fill(&data.bias, -1000, 1000);
  fill(&data.residual, -1000, 1000);
  return data;
}

class Int8Convolution : public testing::Test {
 protected:
  void SetUp() override {
    if (FindByteUnit() == ByteUnit::kNone) GTEST_SKIP() << "this processor has no unit for 8 bits";
  }

  static void ExpectExact(const Case& c) {
    const Data data = Integers(c, 20);
    Data limited = data;
    for (float& value : limited.input) value = std::clamp(value, c.spec.minimum, c.spec.maximum);
    const std::vector<double> expected = ExpectedValues(c, limited);
    const std::vector<float> values = Compute(c, data, 1);
    ASSERT_GE(values.size(), expected.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      // What fills up the last block is zero.
      ASSERT_EQ(values[i], i < expected.size() ? expected[i] : 0) << c.text() << ", value " << i;
    }
    const std::vector<float> again = Compute(c, data, 2);
    EXPECT_EQ(std::memcmp(values.data(), again.data(), values.size() * sizeof(float)), 0)
        << c.text() << ": two threads give other bits than one";
  }
};

TEST_F(Int8Convolution, IsTheExactSumForEveryKernelStrideAndPadding) {
  for (const int kernel : {1, 3, 5}) {
    for (const int stride : {1, 2}) {
      for (const Padding padding :
           {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
        for (const auto& [height, width] :
             std::vector<std::pair<int, int>>{{1, 2}, {5, 8}, {9, 46}}) {
          Case c = OfIntegers({19, 21, kernel, stride, padding, 0.5f}, height, width);
          ExpectExact(c);
          c.with_residual = true;
          ExpectExact(c);
          c.output_layout = Layout::kPlanar;
          ExpectExact(c);
        }
      }
    }
  }
}

TEST_F(Int8Convolution, IsTheExactSumForEveryWidth) {
  for (int width = 1; width <= 40; ++width) {
    for (const int stride : {1, 2}) {
      ExpectExact(OfIntegers({17, 40, 3, stride, Padding::kWrapReplicate, 0}, 3, width));
    }
  }
}

TEST_F(Int8Convolution, IsTheExactSumForEveryNumberOfChannels) {
  for (const int in : {1, 3, 4, 15, 16, 33, 80}) {
    for (const int out : {1, 15, 16, 17, 32, 33, 48, 97}) {
      ExpectExact(OfIntegers({in, out, 3}, 7, 15));
      Case planar = OfIntegers({in, out, 1}, 3, 31);
      planar.output_layout = Layout::kPlanar;
      ExpectExact(planar);
      ExpectExact(OfIntegers({in, out, 1}, 2, 29));
    }
  }
}

TEST_F(Int8Convolution, SumsTheLargestNumbersWithoutOverflow) {
  Case c = OfIntegers({160, 32, 3, 1, Padding::kWrapReplicate, 1}, 2, 4);
  c.spec.minimum = 0;
  c.spec.maximum = 255;
  Data data = Integers(c, 0);
  std::fill(data.weight.begin(), data.weight.end(), 127.0f);
  std::fill(data.input.begin(), data.input.end(), 255.0f);
  std::fill(data.bias.begin(), data.bias.end(), 0.0f);
  const std::vector<float> values = Compute(c, data, 1);
  for (const float value : values) ASSERT_EQ(value, 160.0f * 9 * 127 * 255);
}

TEST_F(Int8Convolution, RoundsInputsToNearestAndLimitsThem) {
  Case c = OfIntegers({16, 16, 1}, 1, 9);
  c.with_bias = false;
  Data data = Integers(c, 0);
  std::fill(data.weight.begin(), data.weight.end(), 0.0f);
  std::fill(data.input.begin(), data.input.end(), 0.0f);
  data.weight[0] = 127;  // from channel 0 to channel 0
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> given = {0.4f,  0.5f,      1.5f,       -2.6f,        1e9f,
                                    -1e9f, kInfinity, -kInfinity, std::nanf("")};
  const std::vector<float> rounded = {0, 0, 2, -3, 218, -37, 218, -37, 218};
  std::copy(given.begin(), given.end(), data.input.begin());
  const std::vector<float> values = Compute(c, data, 1);
  for (std::size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(values[i], 127 * rounded[i]) << given[i];
  }
}

TEST(PackInt8, KeepsTheSumOfAFilterUpToOneRounding) {
  constexpr int kIn = 16, kOut = 16, kTaps = 9;
  const Data data({{kIn, kOut, 3}, 1, 1}, false);
  const Int8Weights packed = PackInt8(data.weight, kOut, kIn, 3, ByteScaleOf(0, 255));
  for (int o = 0; o < kOut; ++o) {
    for (int i = 0; i < kIn; ++i) {
      const auto filter = data.weight.begin() + (o * kIn + i) * kTaps;
      double sum = 0;
      for (int tap = 0; tap < kTaps; ++tap) {
        sum += packed.weight[((tap * kIn + i / 4 * 4) * kOut) + o * 4 + i % 4];
      }
      const double wanted = std::accumulate(filter, filter + kTaps, 0.0) / packed.scale[o];
      EXPECT_NEAR(sum, wanted, 0.51) << o << ' ' << i;
    }
  }
}

TEST(ByteScaleOf, RepresentsZeroExactlyForEveryRange) {
  for (const auto& [low, high] :
       std::vector<std::pair<float, float>>{{0, 1}, {-0.5f, 12}, {-3, 0.1f}, {2, 5}, {0, 0}}) {
    const ByteScale scale = ByteScaleOf(low, high);
    EXPECT_GT(scale.steps, 0);
    EXPECT_GE(scale.zero, 0);
    EXPECT_LE(scale.zero, 255);
    EXPECT_NEAR(static_cast<float>(scale.zero) / scale.steps, -std::min(low, 0.0f),
                0.51 / scale.steps);
  }
}

TEST(ByteScaleOf, MovesBytesWithSignsByAConstantSoThatSumsStayTheSame) {
  constexpr int kIn = 16, kOut = 16;
  constexpr std::int32_t kLowest = -128;
  const Data data({{kIn, kOut, 1}, 1, 1}, false);
  const ByteScale without = ByteScaleOf(-3, 12);
  const ByteScale with = ByteScaleOf(-3, 12, kLowest);
  EXPECT_EQ(with.steps, without.steps);
  EXPECT_EQ(with.zero, without.zero + kLowest);
  const Int8Weights plain = PackInt8(data.weight, kOut, kIn, 1, without);
  const Int8Weights moved = PackInt8(data.weight, kOut, kIn, 1, with);
  ASSERT_EQ(plain.weight, moved.weight);
  for (int o = 0; o < kOut; ++o) {
    // Any inputs, here 7 times the number of the channel.
    std::int32_t sum = plain.first_sum[o], moved_sum = moved.first_sum[o];
    for (int i = 0; i < kIn; ++i) {
      const int weight = plain.weight[i / 4 * 4 * kOut + o * 4 + i % 4];
      sum += weight * (7 * i);
      moved_sum += weight * (7 * i + kLowest);
    }
    EXPECT_EQ(moved_sum, sum) << o;
  }
}

}  // namespace
}  // namespace orb360::nn
