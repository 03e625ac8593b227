#include "tests/nn/kernels/convolution_case.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/tensor_memory.h"
#include <orb360/nn/base/aligned_vector.h>

namespace orb360::nn {
namespace {

std::vector<float> Random(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(generator);
  return values;
}

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
  const int in_channels = c.spec.in_channels;
  const int kernel = c.spec.kernel;
  const int stride = c.spec.stride;
  const Padding padding = c.spec.padding;
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
  if (!(sum.value > 0)) sum.value *= c.spec.slope;
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

}  // namespace

std::string Case::text() const {
  std::ostringstream out;
  out << spec.in_channels << "->" << spec.out_channels << " k" << spec.kernel << " s" << spec.stride
      << " padding " << static_cast<int>(spec.padding) << " slope " << spec.slope << ' ' << height
      << 'x' << width << (input_layout == Layout::kPlanar ? " from planar" : "")
      << (output_layout == Layout::kPlanar ? " to planar" : "") << (with_bias ? " bias" : "")
      << (with_residual ? " residual" : "")
      << (spec.type == DataType::kBFloat16 ? " of bfloat16" : "")
      << (spec.type == DataType::kInt8 ? " of 8 bits" : "")
      << (output_type == DataType::kBFloat16 ? " to bfloat16" : "");
  return out.str();
}

Data::Data(const Case& c, bool rounds)
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

std::vector<double> ExpectedValues(const Case& c, const Data& data) {
  const Shape out = c.output_shape();
  std::vector<double> values;
  for (int o = 0; o < out.channels; ++o) {
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) values.push_back(Expected(c, data, o, y, x).value);
    }
  }
  return values;
}

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
  AlignedVector<std::byte> scratch(convolution.ScratchBytes(input.shape, threads), std::byte{0x7f});
  convolution.Run(input, residual, output, scratch, threads);
}

std::vector<float> Compute(const Case& c, const Data& data, int threads, BFloat16Unit unit) {
  const Convolution convolution(c.spec, data.weight, data.bias, unit);
  // One pixel more than needed, so that the strides differ from the smallest possible.
  TensorMemory input({c.input_shape(), c.input_layout, c.input_type(), c.spec.kernel / 2 + 1});
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

void ExpectRight(const Case& c) {
  if (c.spec.type == DataType::kFloat) {
    ExpectRight(c, Data(c), BestBFloat16Unit());
    return;
  }
  for (const BFloat16Unit unit : {BFloat16Unit::kAvx512, BFloat16Unit::kAmx}) {
    if (unit > BestBFloat16Unit()) continue;
    SCOPED_TRACE(unit == BFloat16Unit::kAmx ? "AMX" : "AVX-512");
    // Images are not rounded.
    ExpectRight(c, Data(c, !c.is_stem()), unit);
  }
}

}  // namespace orb360::nn
