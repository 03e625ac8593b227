#include "nn/kernels/convolution.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nn/base/aligned_vector.h"
#include "nn/base/check.h"
#include "tests/dispatch_targets.h"
#include "tests/nn/tensor_memory.h"

namespace orb360::nn {
namespace {

std::vector<float> Random(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(generator);
  return values;
}

// A convolution of random numbers, with everything that goes into it in plain arrays.
struct Case {
  ConvolutionSpec spec;
  int height = 1;
  int width = 1;
  Layout input_layout = Layout::kBlocked;
  Layout output_layout = Layout::kBlocked;
  DataType output_type = DataType::kFloat;
  bool with_bias = true;
  bool with_residual = false;

  bool is_stem() const {
    return spec.type == DataType::kBFloat16 && input_layout == Layout::kPlanar;
  }
  Shape input_shape() const { return {spec.in_channels, height, width}; }
  Shape output_shape() const {
    return {spec.out_channels, (height + spec.stride - 1) / spec.stride,
            (width + spec.stride - 1) / spec.stride};
  }
  std::string text() const {
    std::ostringstream out;
    out << spec.in_channels << "->" << spec.out_channels << " k" << spec.kernel << " s"
        << spec.stride << " padding " << static_cast<int>(spec.padding) << " slope " << spec.slope
        << ' ' << height << 'x' << width << (input_layout == Layout::kPlanar ? " from planar" : "")
        << (output_layout == Layout::kPlanar ? " to planar" : "") << (with_bias ? " bias" : "")
        << (with_residual ? " residual" : "")
        << (spec.type == DataType::kBFloat16 ? " of bfloat16" : "")
        << (output_type == DataType::kBFloat16 ? " to bfloat16" : "");
    return out.str();
  }
};

std::vector<float> Rounded(std::vector<float> values) {
  const Shape shape{1, 1, static_cast<int>(values.size())};
  TensorMemory plain({shape, Layout::kPlanar, DataType::kFloat, 0});
  TensorMemory rounded({shape, Layout::kPlanar, DataType::kBFloat16, 0});
  std::copy(values.begin(), values.end(), plain.view.row<float>(0, 0));
  Reorder(plain.view, rounded.view);
  Reorder(rounded.view, plain.view);
  std::copy_n(plain.view.row<float>(0, 0), values.size(), values.begin());
  return values;
}

struct Data {
  explicit Data(const Case& c) : Data(c, c.spec.type == DataType::kBFloat16) {}
  Data(const Case& c, bool rounds)
      : weight(Random(static_cast<std::size_t>(c.spec.out_channels) * c.spec.in_channels *
                          c.spec.kernel * c.spec.kernel,
                      1)),
        bias(c.with_bias ? Random(c.spec.out_channels, 2) : std::vector<float>{}),
        input(Random(static_cast<std::size_t>(c.spec.in_channels) * c.height * c.width, 3)),
        residual(Random(static_cast<std::size_t>(c.spec.out_channels) * c.output_shape().height *
                            c.output_shape().width,
                        4)) {
    if (rounds) {
      weight = Rounded(weight);
      input = Rounded(input);
    }
    if (c.output_type == DataType::kBFloat16) residual = Rounded(residual);
  }
  std::vector<float> weight, bias, input, residual;
};

void Fill(const TensorView& tensor, const std::vector<float>& values) {
  TensorMemory planar({tensor.shape, Layout::kPlanar, DataType::kFloat, 0});
  std::size_t next = 0;
  for (int c = 0; c < tensor.shape.channels; ++c) {
    for (int y = 0; y < tensor.shape.height; ++y) {
      for (int x = 0; x < tensor.shape.width; ++x) At(planar.view, c, y, x) = values[next++];
    }
  }
  Reorder(planar.view, tensor);
}

void RunOn(const Convolution& convolution, const TensorView& input, const TensorView* residual,
           const TensorView& output, int threads) {
  AlignedVector<std::byte> scratch(convolution.ScratchBytes(threads), std::byte{0x7f});
  convolution.Run(input, residual, output, scratch, threads);
}

// The output, channel by channel, behind whatever the blocks are filled up with.
std::vector<float> Compute(const Case& c, const Data& data, int threads,
                           BFloat16Unit unit = BestBFloat16Unit()) {
  const Convolution convolution(c.spec, data.weight, data.bias, unit);
  // One pixel more than needed, so that the strides differ from the smallest possible.
  TensorMemory input({c.input_shape(), c.input_layout, c.is_stem() ? DataType::kFloat : c.spec.type,
                      c.spec.kernel / 2 + 1});
  TensorMemory output({c.output_shape(), c.output_layout, c.output_type, 1});
  TensorMemory residual({c.output_shape(), c.output_layout, c.output_type, 0});
  EXPECT_EQ(convolution.OutputShape(c.input_shape()), c.output_shape());
  Fill(input.view, data.input);
  Fill(residual.view, data.residual);
  RunOn(convolution, input.view, c.with_residual ? &residual.view : nullptr, output.view, threads);
  TensorView whole = output.view;
  if (c.output_layout == Layout::kBlocked) {
    whole.shape.channels = whole.planes() * BlockOf(c.output_type);
  }
  TensorMemory planar({whole.shape, Layout::kPlanar, DataType::kFloat, 0});
  Reorder(whole, planar.view);
  std::vector<float> values;
  for (int o = 0; o < whole.shape.channels; ++o) {
    for (int y = 0; y < whole.shape.height; ++y) {
      const float* row = planar.view.row<float>(o, y);
      values.insert(values.end(), row, row + whole.shape.width);
    }
  }
  return values;
}

// The sum of a window in double precision, and the sum of its terms' magnitudes.
struct Sum {
  double value = 0;
  double norm = 0;
  void Add(double term) {
    value += term;
    norm += std::abs(term);
  }
};

Sum Expected(const Case& c, const Data& data, int o, int y, int x) {
  const auto& [in_channels, out_channels, kernel, stride, padding, slope, type, may_tile] = c.spec;
  const int reach = kernel / 2;
  Sum sum;
  for (int i = 0; i < in_channels; ++i) {
    for (int v = 0; v < kernel; ++v) {
      for (int u = 0; u < kernel; ++u) {
        int row = y * stride + v - reach;
        int column = x * stride + u - reach;
        if (padding == Padding::kZero &&
            (row < 0 || row >= c.height || column < 0 || column >= c.width)) {
          continue;
        }
        if (padding == Padding::kWrapReplicate) row = std::clamp(row, 0, c.height - 1);
        while (row < 0 || row >= c.height) {
          row = row < 0 ? -1 - row : 2 * c.height - 1 - row;
          column += c.width / 2;
        }
        column = (column % c.width + c.width) % c.width;
        sum.Add(double{data.weight[((o * in_channels + i) * kernel + v) * kernel + u]} *
                data.input[(i * c.height + row) * c.width + column]);
      }
    }
  }
  if (c.with_bias) sum.Add(data.bias[o]);
  if (c.with_residual) {
    const Shape& out = c.output_shape();
    sum.Add(data.residual[(o * out.height + y) * out.width + x]);
  }
  if (!(sum.value > 0)) sum.value *= slope;
  return sum;
}

// A sum of n rounded products in any order is off by at most about n units of rounding of the sum
// of the magnitudes; the activation rounds once more, and bfloat16 has 8 bits.
double Tolerance(const Case& c, const Sum& sum) {
  const int terms = c.spec.in_channels * c.spec.kernel * c.spec.kernel + 3;
  const double tolerance = terms * 0.5 * std::numeric_limits<float>::epsilon() * sum.norm;
  if (c.output_type == DataType::kFloat) return tolerance;
  constexpr double kRounding = 1.0 / 256;
  return tolerance + kRounding * (std::abs(sum.value) + tolerance);
}

// Looks for the largest error over what is tolerated.
void ExpectRight(const Case& c, const Data& data, BFloat16Unit unit) {
  const Shape out = c.output_shape();
  std::vector<Sum> expected;
  for (int o = 0; o < out.channels; ++o) {
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) expected.push_back(Expected(c, data, o, y, x));
    }
  }
  const auto check = [&] {
    const std::vector<float> values = Compute(c, data, 1, unit);
    double worst = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double error = std::abs(values[i] - expected[i].value);
      const double ratio = error == 0 ? 0 : error / Tolerance(c, expected[i]);
      if (!(ratio <= worst)) {
        worst = std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio;
        at = i;
      }
    }
    const int pixels = out.height * out.width;
    EXPECT_LE(worst, 1) << c.text() << ", worst at channel " << at / pixels << " row "
                        << at % pixels / out.width << " column " << at % out.width << ": "
                        << values[at] << " instead of " << expected[at].value;
    for (std::size_t i = expected.size(); i < values.size(); ++i) {
      ASSERT_EQ(values[i], 0) << c.text() << ", in what fills up the last block";
    }
    const std::vector<float> again = Compute(c, data, 2, unit);
    EXPECT_EQ(std::memcmp(values.data(), again.data(), values.size() * sizeof(float)), 0)
        << c.text() << ": two threads give other bits than one";
  };
  if (c.spec.type == DataType::kBFloat16) {
    check();
  } else {
    ForEachDispatchTarget(check);
  }
}

void ExpectRight(const Case& c) {
  if (c.spec.type == DataType::kFloat) {
    ExpectRight(c, Data(c), BestBFloat16Unit());
    return;
  }
  for (const BFloat16Unit unit : {BFloat16Unit::kAvx512, BFloat16Unit::kAmx}) {
    if (unit > BestBFloat16Unit()) continue;
    SCOPED_TRACE(unit == BFloat16Unit::kAmx ? "AMX" : "AVX-512");
    // Pictures are not rounded.
    ExpectRight(c, Data(c, !c.is_stem()), unit);
  }
}

TEST(Convolution, IsThePlainSumForEveryKernelStrideAndPadding) {
  for (const int kernel : {1, 3, 5}) {
    for (const int stride : {1, 2}) {
      for (const Padding padding :
           {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
        for (const auto& [height, width] :
             std::vector<std::pair<int, int>>{{1, 2}, {5, 8}, {9, 46}}) {
          Case c{{19, 21, kernel, stride, padding, 0.1f}, height, width};
          ExpectRight(c);
          c.with_residual = true;
          ExpectRight(c);
        }
      }
    }
  }
}

TEST(Convolution, IsThePlainSumForEveryWidth) {
  for (int width = 1; width <= 40; ++width) {
    for (const int stride : {1, 2}) {
      ExpectRight({{17, 40, 3, stride, Padding::kWrapReplicate, 0}, 3, width});
    }
  }
}

TEST(Convolution, InTilesIsThePlainSumForEverySize) {
  for (int width = 1; width <= 17; ++width) {
    for (const int height : {1, 3, 4, 5, 9}) {
      Case c{{16, 20, 3, 1, Padding::kWrapReplicate, 0.1f}, height, width};
      c.with_residual = width % 2 == 0;
      ExpectRight(c);
      c.output_layout = Layout::kPlanar;
      ExpectRight(c);
    }
  }
  ExpectRight({{48, 80, 3, 1, Padding::kWrapCrossPole, 0}, 26, 54});
}

TEST(Convolution, TurnsWithThePictureByAnyColumnOrByTiles) {
  Case c{{32, 32, 3, 1, Padding::kWrapReplicate, 0.1f}, 6, 12};
  for (const bool may_tile : {false, true}) {
    c.spec.may_tile = may_tile;
    Data data(c);
    const std::vector<float> before = Compute(c, data, 1);
    const int columns = may_tile ? kConvolutionTile : 1;
    for (std::size_t row = 0; row < data.input.size(); row += c.width) {
      const auto begin = data.input.begin() + static_cast<std::ptrdiff_t>(row);
      std::rotate(begin, begin + columns, begin + c.width);
    }
    const std::vector<float> turned = Compute(c, data, 1);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const std::size_t column = i % c.width;
      ASSERT_EQ(turned[i], before[i - column + (column + columns) % c.width]) << i;
    }
  }
}

TEST(Convolution, IsThePlainSumForEveryNumberOfChannels) {
  for (const int in : {1, 2, 15, 16, 33, 80}) {
    for (const int out : {1, 16, 31, 38, 48, 64, 80, 97}) {
      Case c{{in, out, 3, 1, Padding::kZero, 0.2f}, 3, 15};
      ExpectRight(c);
      c.spec.may_tile = false;
      ExpectRight(c);
      ExpectRight({{in, out, 1, 1, Padding::kZero, 1}, 2, 29});
    }
  }
}

TEST(Convolution, IsThePlainSumFromAndToPlanes) {
  for (const int in : {1, 2, 5, 6, 8}) {
    for (const int stride : {1, 2}) {
      for (const int kernel : {1, 3, 5}) {
        for (const int width : {1, 7, 33, 64}) {
          Case c{{in, 38, kernel, stride, Padding::kWrapReplicate, 0.1f}, 5, width};
          c.input_layout = Layout::kPlanar;
          ExpectRight(c);
          c.output_layout = Layout::kPlanar;
          c.with_residual = true;
          ExpectRight(c);
        }
      }
    }
  }
  for (const int out : {1, 16, 38}) {
    Case c{{32, out, 1}, 3, 50};
    c.output_layout = Layout::kPlanar;
    ExpectRight(c);
  }
}

TEST(Convolution, OfOnePixelSeesItAroundTheSphere) {
  for (const Padding padding : {Padding::kZero, Padding::kWrapReplicate}) {
    for (const int kernel : {1, 3, 5}) ExpectRight({{20, 20, kernel, 1, padding, 0}, 1, 1});
  }
}

TEST(Convolution, ActivatesWithAnySlope) {
  for (const float slope : {0.0f, 0.1f, 1.0f, -1.0f, 2.0f}) {
    Case c{{16, 16, 3, 1, Padding::kZero, slope}, 4, 20};
    c.with_bias = false;
    ExpectRight(c);
  }
}

TEST(Convolution, AddsAResidualInPlace) {
  Case c{{32, 32, 3, 1, Padding::kWrapReplicate, 0.1f}, 6, 31};
  c.with_residual = true;
  Data data(c);
  // Where infinity is, tiles are computed in another way.
  for (const float value : {0.0f, std::numeric_limits<float>::infinity()}) {
    data.input[40] = value;
    const std::vector<float> expected = Compute(c, data, 1);
    const Convolution convolution(c.spec, data.weight, data.bias);
    TensorMemory input({c.input_shape(), Layout::kBlocked, DataType::kFloat, 1});
    TensorMemory output({c.output_shape(), Layout::kBlocked, DataType::kFloat, 0});
    Fill(input.view, data.input);
    Fill(output.view, data.residual);
    RunOn(convolution, input.view, &output.view, output.view, 2);
    std::size_t next = 0;
    for (int o = 0; o < 32; ++o) {
      for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 31; ++x) ASSERT_EQ(At(output.view, o, y, x), expected[next++]);
      }
    }
  }
}

TEST(Convolution, ReadsAndWritesSlicesOfChannels) {
  const Case c{{20, 16, 3}, 4, 9};
  const Data data(c);
  const std::vector<float> expected = Compute(c, data, 1);
  const Convolution convolution(c.spec, data.weight, data.bias);
  TensorMemory input({{52, 4, 9}, Layout::kBlocked, DataType::kFloat, 1});
  TensorMemory output({{48, 4, 9}, Layout::kBlocked, DataType::kFloat, 1});
  Fill(ChannelSlice(input.view, 32, 20), data.input);
  RunOn(convolution, ChannelSlice(input.view, 32, 20), nullptr, ChannelSlice(output.view, 16, 16),
        1);
  float untouched;
  std::memset(&untouched, 0x7f, sizeof(untouched));
  std::size_t next = 0;
  for (int o = 0; o < 48; ++o) {
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 9; ++x) {
        const bool inside = o >= 16 && o < 32;
        ASSERT_EQ(At(output.view, o, y, x), inside ? expected[next++] : untouched) << o;
      }
    }
  }
}

TEST(Convolution, CarriesNanAndInfinityToTheirWindowsOnly) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const int stride : {1, 2}) {
      const Case c{{24, 20, 3, stride, Padding::kZero, 0}, 9, 37};
      Data data(c);
      std::fill(data.weight.begin(), data.weight.end(), 1.0f);
      data.input[(20 * 9 + 4) * 37 + 18] = value;  // channel 20, row 4, column 18
      const std::vector<float> values = Compute(c, data, 1);
      const Shape out = c.output_shape();
      for (int o = 0; o < 32; ++o) {
        for (int y = 0; y < out.height; ++y) {
          for (int x = 0; x < out.width; ++x) {
            const float at = values[(o * out.height + y) * out.width + x];
            const bool reached =
                o < out.channels && std::abs(y * stride - 4) <= 1 && std::abs(x * stride - 18) <= 1;
            ASSERT_EQ(std::isfinite(at), !reached) << o << ' ' << y << ' ' << x;
            if (reached) {
              ASSERT_EQ(std::isnan(at), std::isnan(value));
            }
          }
        }
      }
    }
  }
}

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
  for (const int in : {9, 31, 32, 64, 80}) {
    for (const int out : {1, 16, 17, 32, 38, 64, 97}) {
      ExpectRightInAllFormats({{in, out, 3}, 2, 20});
      ExpectRightInAllFormats({{in, out, 1}, 1, 50});
    }
  }
}

TEST_F(BFloat16Convolution, TakesPicturesAsFloats) {
  for (const int in : {1, 3, 6, 8}) {
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

TEST(Convolution, RefusesWhatDoesNotFit) {
  const std::vector<float> weight(16 * 16 * 9);
  EXPECT_THROW(Convolution({16, 16, 2}, weight, {}), ContractError);
  EXPECT_THROW(Convolution({16, 16, 3, 3}, weight, {}), ContractError);
  EXPECT_THROW(Convolution({16, 15, 3}, weight, {}), ContractError);
  EXPECT_THROW(Convolution({16, 16, 3}, weight, std::vector<float>(15)), ContractError);
  const Convolution convolution({16, 16, 3}, weight, {});
  TensorMemory input({{16, 4, 4}, Layout::kBlocked, DataType::kFloat, 1});
  TensorMemory narrow({{16, 4, 4}, Layout::kBlocked, DataType::kFloat, 0});
  TensorMemory planar({{16, 4, 4}, Layout::kPlanar, DataType::kFloat, 1});
  TensorMemory small({{16, 4, 3}, Layout::kBlocked, DataType::kFloat, 0});
  EXPECT_THROW(RunOn(convolution, narrow.view, nullptr, input.view, 1), ContractError);
  EXPECT_THROW(RunOn(convolution, planar.view, nullptr, narrow.view, 1), ContractError);
  EXPECT_THROW(RunOn(convolution, input.view, nullptr, small.view, 1), ContractError);
  EXPECT_THROW(RunOn(convolution, input.view, &small.view, narrow.view, 1), ContractError);
  TensorMemory rounded({{16, 4, 4}, Layout::kBlocked, DataType::kBFloat16, 1});
  EXPECT_THROW(RunOn(convolution, rounded.view, nullptr, narrow.view, 1), ContractError);
  EXPECT_THROW(RunOn(convolution, input.view, nullptr, rounded.view, 1), ContractError);
  const ConvolutionSpec of_bfloat16{16, 16, 3, 1, Padding::kZero, 1, DataType::kBFloat16};
  EXPECT_THROW(Convolution(of_bfloat16, weight, {}, BFloat16Unit::kNone), ContractError);
}

}  // namespace
}  // namespace orb360::nn
