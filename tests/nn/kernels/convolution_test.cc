#include "nn/kernels/convolution.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/nn/kernels/convolution_case.h"
#include "tests/nn/tensor_memory.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

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
  for (const int stride : {1, 2}) {
    for (int width = 1; width <= 17 * stride; width += 2 * stride - 1) {
      for (const int height : {1, 4, 9, 16}) {
        Case c{{16, 20, 3, stride, Padding::kWrapReplicate, 0.1f}, height, width};
        c.with_residual = width % 3 == 0;
        ExpectRight(c);
        c.output_layout = Layout::kPlanar;
        ExpectRight(c);
      }
    }
    ExpectRight({{48, 80, 3, stride, Padding::kWrapCrossPole, 0}, 26 * stride, 54 * stride});
  }
}

TEST(Convolution, TurnsWithTheImageByAnyColumnOrByTiles) {
  for (const auto& [stride, padding] : {std::pair{1, Padding::kWrapReplicate},
                                        {2, Padding::kWrapReplicate},
                                        {2, Padding::kWrapCrossPole}}) {
    Case c{{32, 32, 3, stride, padding, 0.1f}, 6, 24};
    for (const bool may_tile : {false, true}) {
      c.spec.may_tile = may_tile;
      Data data(c);
      const std::vector<float> before = Compute(c, data, 1);
      const int columns = may_tile ? kConvolutionTile : 1;  // of the output
      for (std::size_t row = 0; row < data.input.size(); row += c.width) {
        const auto begin = data.input.begin() + static_cast<std::ptrdiff_t>(row);
        std::rotate(begin, begin + columns * stride, begin + c.width);
      }
      const std::vector<float> turned = Compute(c, data, 1);
      const std::size_t width = c.width / stride;
      for (std::size_t i = 0; i < before.size(); ++i) {
        const std::size_t column = i % width;
        ASSERT_EQ(turned[i], before[i - column + (column + columns) % width]) << stride << ' ' << i;
      }
    }
  }
}

TEST(Convolution, IsThePlainSumForEveryNumberOfChannels) {
  for (const int in : {1, 2, 15, 16, 33, 80}) {
    for (const int out : {1, 8, 9, 16, 24, 31, 38, 48, 64, 80, 97}) {
      Case c{{in, out, 3, 1, Padding::kZero, 0.2f}, 3, 15};
      ExpectRight(c);
      c.spec.may_tile = false;
      ExpectRight(c);
      ExpectRight({{in, out, 1, 1, Padding::kZero, 1}, 2, 29});
    }
  }
}

TEST(Convolution, IsThePlainSumFromAndToPlanes) {
  for (const int in : {1, 2, 5, 6, 8, 9, kMaxPlanarChannels}) {
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
  // Planes are written in squares of channels and pixels, and a part of a row at a time.
  for (const int out : {1, 3, 4, 8, 9, 16, 24, 38, 40}) {
    for (const int width : {1, 3, 4, 7, 8, 9, 50, 55, 56, 57, 64, 121}) {
      Case c{{32, out, 1, 1, Padding::kZero, 0.1f}, 3, width};
      c.output_layout = Layout::kPlanar;
      ExpectRight(c);
      c.with_residual = true;
      ExpectRight(c);
    }
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
  for (const int stride : {1, 2}) {
    Case c{{32, 32, 3, stride, Padding::kWrapReplicate, 0.1f}, 6, 31};
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
      const Shape out = c.output_shape();
      std::size_t next = 0;
      for (int o = 0; o < out.channels; ++o) {
        for (int y = 0; y < out.height; ++y) {
          for (int x = 0; x < out.width; ++x) {
            ASSERT_EQ(At(output.view, o, y, x), expected[next++]);
          }
        }
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
  const int height = 18;
  const int width = 37;
  for (const int stride : {1, 2}) {
    const Case c{{24, 20, 3, stride, Padding::kZero, 0}, height, width};
    const Shape out = c.output_shape();
    const Data plain = [&] {
      Data data(c);
      std::fill(data.weight.begin(), data.weight.end(), 1.0f);
      return data;
    }();
    // Each place in a tile, and those that two tiles see.
    for (int place = 0; place < 81; ++place) {
      const int row = 7 + place / 9;
      const int column = 15 + place % 9;
      const float value = place % 2 == 0 ? std::numeric_limits<float>::quiet_NaN()
                                         : std::numeric_limits<float>::infinity();
      Data data = plain;
      data.input[(20 * height + row) * width + column] = value;  // channel 20
      const std::vector<float> values = Compute(c, data, 1);
      for (int o = 0; o < 32; ++o) {
        for (int y = 0; y < out.height; ++y) {
          for (int x = 0; x < out.width; ++x) {
            const float at = values[(o * out.height + y) * out.width + x];
            const bool reached = o < out.channels && std::abs(y * stride - row) <= 1 &&
                                 std::abs(x * stride - column) <= 1;
            ASSERT_EQ(std::isfinite(at), !reached)
                << stride << ' ' << place << ' ' << o << ' ' << y << ' ' << x;
            if (reached) {
              ASSERT_EQ(std::isnan(at), std::isnan(value));
            }
          }
        }
      }
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
