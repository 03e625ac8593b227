#include "nn/kernels/elementwise.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Shape kShapes[] = {{1, 1, 1}, {2, 3, 5}, {1, 2, 37}, {17, 3, 7}, {32, 2, 3}};

struct Function {
  std::string name;
  std::function<void(const TensorView&, const TensorView&, int)> run;
  std::function<double(double)> expected;
  float units;  // in the last place of the result: what it may be off, beyond half a unit
  float lowest = -30;
  float highest = 30;
};

// `units` are Highway's (hwy/contrib/math) plus what is added to its result.
const std::vector<Function>& Functions() {
  static const std::vector<Function> kFunctions = {
      {"relu", Relu, [](double x) { return x < 0 ? 0 : x; }, 0},
      {"leaky_relu",
       [](const TensorView& x, const TensorView& y, int threads) {
         LeakyRelu(x, 0.2f, y, threads);
       },
       [](double x) { return x < 0 ? static_cast<double>(0.2f) * x : x; }, 0},
      {"tanh", Tanh, [](double x) { return std::tanh(x); }, 4},
      {"sigmoid", Sigmoid, [](double x) { return 1 / (1 + std::exp(-x)); }, 3, -87, 87},
      {"softplus", Softplus,
       [](double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }, 4, -87, 87},
      {"exp", Exp, [](double x) { return std::exp(x); }, 1, -87, 88},
      {"log", Log, [](double x) { return std::log(x); }, 4, 1e-6f, 30},
      {"clamp",
       [](const TensorView& x, const TensorView& y, int threads) { Clamp(x, 1, 2.5, y, threads); },
       [](double x) { return x < 1     ? 1
                             : x > 2.5 ? 2.5
                                       : x; }, 0},
  };
  return kFunctions;
}

// One unit in the last place of a float of this size, from the smallest normal one on.
double UnitInTheLastPlace(double value) {
  int exponent;
  std::frexp(std::max(std::abs(value), 0x1p-126), &exponent);
  return std::ldexp(1.0, exponent - 24);
}

void ExpectFunction(const Function& function, const PlainImage& x, Layout layout) {
  SCOPED_TRACE(function.name);
  PlainImage expected(x.shape);
  PlainImage tolerance(x.shape);
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    expected.values[i] = function.expected(x.values[i]);
    tolerance.values[i] = (function.units + 0.5) * UnitInTheLastPlace(expected.values[i]);
  }
  const FilledTensor input(x, layout, 0);
  const TensorMemory one({x.shape, layout, DataType::kFloat, 2});
  const TensorMemory two({x.shape, layout, DataType::kFloat, 0});
  function.run(input.view, one.view, 1);
  function.run(input.view, two.view, 2);
  ExpectNear(one.view, expected, tolerance);
  ExpectSameBits(one.view, two.view);
  function.run(input.view, input.view, 1);
  ExpectSameBits(one.view, input.view);
}

TEST(Elementwise, FunctionsAreAccurateInEveryLayoutShapeAndInPlace) {
  ForEachDispatchTarget([] {
    for (const Function& function : Functions()) {
      for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
        for (const Shape& shape : kShapes) {
          ExpectFunction(function, RandomImage(shape, function.lowest, function.highest, 3),
                         layout);
        }
      }
    }
  });
}

// Every exponent, both signs: the range where they would lose accuracy, overflow or fall to zero.
TEST(Elementwise, FunctionsKeepTheirAccuracyForEveryMagnitude) {
  ForEachDispatchTarget([] {
    for (const Function& function : Functions()) {
      std::vector<double> values = {0.0, -0.0};
      const std::vector<float> mantissas = RandomFloats(8, 1.0f, 2.0f, 4);
      for (int exponent = -126; exponent < 128; ++exponent) {
        for (const float mantissa : mantissas) {
          const double value = std::ldexp(static_cast<double>(mantissa), exponent);
          values.push_back(value);
          if (function.name != "log") values.push_back(-value);
        }
      }
      // What is no normal float any more is not held to a unit in the last place.
      const auto is_vague = [&](double x) {
        const double y = std::abs(function.expected(x));
        return y != 0 && (y < 0x1p-126 || y > std::numeric_limits<float>::max());
      };
      std::erase_if(values, is_vague);
      PlainImage x({1, 1, static_cast<int>(values.size())});
      x.values = values;
      ExpectFunction(function, x, Layout::kPlanar);
    }
  });
}

TEST(Elementwise, NotANumberStaysOneAndInfinityGoesToTheLimit) {
  ForEachDispatchTarget([] {
    for (const Function& function : Functions()) {
      PlainImage x({1, 1, 3});
      x.values = {kNan, kInfinity, function.name == "log" ? 0 : -kInfinity};
      ExpectFunction(function, x, Layout::kPlanar);
    }
    PlainImage x({1, 1, 2});
    x.values = {-1, -kInfinity};
    const FilledTensor tensor(x, Layout::kPlanar, 0);
    Log(tensor.view, tensor.view, 1);
    EXPECT_TRUE(std::isnan(At(tensor.view, 0, 0, 0)));
    EXPECT_TRUE(std::isnan(At(tensor.view, 0, 0, 1)));
  });
}

TEST(Elementwise, ArithmeticOfTensorsAndConstantsRoundsLikeArithmetic) {
  ForEachDispatchTarget([] {
    for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
      for (const Shape& shape : kShapes) {
        const PlainImage a = RandomImage(shape, -3.0f, 3.0f, 5);
        PlainImage b = RandomImage(shape, -3.0f, 3.0f, 6);
        b.values[0] = kNan;
        const FilledTensor first(a, layout, 0);
        const FilledTensor second(b, layout, 1);
        PlainImage sum(shape);
        PlainImage product(shape);
        PlainImage affine(shape);
        PlainImage affine_tolerance(shape);
        for (std::size_t i = 0; i < a.values.size(); ++i) {
          sum.values[i] = static_cast<float>(a.values[i] + b.values[i]);
          product.values[i] = static_cast<float>(a.values[i] * b.values[i]);
          affine.values[i] = 0.3f * b.values[i] + 0.7f;
          affine_tolerance.values[i] = 2 * 0x1p-24 * (std::abs(0.3f * b.values[i]) + 0.7f);
        }
        for (const int threads : {1, 2}) {
          const TensorMemory y({shape, layout, DataType::kFloat, 0});
          Add(first.view, second.view, y.view, threads);
          ExpectEqual(y.view, sum);
          Multiply(first.view, second.view, y.view, threads);
          ExpectEqual(y.view, product);
          Affine(second.view, 0.3f, 0.7f, y.view, threads);
          ExpectNear(y.view, affine, affine_tolerance);
        }
      }
    }
  });
}

TEST(Elementwise, RefusesTensorsThatDoNotFit) {
  const TensorMemory x({{2, 3, 4}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory wide({{2, 3, 5}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory blocked({{2, 3, 4}, Layout::kBlocked, DataType::kFloat, 0});
  const TensorMemory half({{2, 3, 4}, Layout::kPlanar, DataType::kBFloat16, 0});
  EXPECT_THROW(Relu(x.view, wide.view, 1), ContractError);
  EXPECT_THROW(Add(x.view, blocked.view, x.view, 1), ContractError);
  EXPECT_THROW(Exp(half.view, half.view, 1), ContractError);
  EXPECT_THROW(Clamp(x.view, 2, 1, x.view, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
