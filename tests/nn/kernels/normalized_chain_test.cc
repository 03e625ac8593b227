#include "nn/kernels/normalized_chain.h"

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "nn/kernels/upsample.h"
#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr double kEpsilon = 0x1p-24;  // half a unit in the last place of 1
constexpr Padding kPaddings[] = {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole};

struct Layer {
  int outputs;
  int inputs;
  int size;
};

// The layers of published networks, which have kernels of their own, and others.
constexpr Layer kLayers[] = {{2, 1, 5}, {2, 2, 5}, {2, 4, 3}, {1, 2, 1}, {2, 2, 3},
                             {1, 1, 3}, {3, 5, 3}, {7, 3, 1}, {5, 2, 7}, {1, 1, 15}};

struct Weights {
  explicit Weights(const Layer& layer)
      : weight(RandomFloats(
            static_cast<std::size_t>(layer.outputs) * layer.inputs * layer.size * layer.size, 0.01f,
            1.0f, 5)),
        bias(RandomFloats(layer.outputs, -0.5f, 0.5f, 6)) {}
  NormalizedConvolution Kernel(const Layer& layer, Padding padding) const {
    return {weight, bias, layer.outputs, layer.inputs, layer.size, padding};
  }
  std::vector<float> weight;
  std::vector<float> bias;
};

// Runs a convolution by itself.
void RunSingle(const NormalizedConvolution& kernel, const TensorView& x, const TensorView& c,
               const TensorView& y, const TensorView& y_confidence, int threads) {
  const NormalizedChain chain({kernel});
  const Scratch scratch(chain.ScratchBytes(x.shape.width, threads));
  const NormalizedInput input{{x, c}};
  chain.Run({&input, 1}, {y, y_confidence}, scratch.bytes, threads);
}

struct Expected {
  explicit Expected(const Shape& shape) : y(shape), c(shape), y_bound(shape), c_bound(shape) {}
  PlainImage y;
  PlainImage c;
  PlainImage y_bound;
  PlainImage c_bound;
};

// Bounds: every sum of n products is off by at most n + 1 roundings of the sum of magnitudes.
Expected Reference(const Weights& weights, const Layer& layer, Padding padding, const PlainImage& x,
                   const PlainImage& c) {
  Expected expected({layer.outputs, x.shape.height, x.shape.width});
  const int reach = layer.size / 2;
  const double taps = layer.inputs * layer.size * layer.size;
  const double roundings = (taps + 4) * kEpsilon;
  for (int o = 0; o < layer.outputs; ++o) {
    for (int v = 0; v < x.shape.height; ++v) {
      for (int u = 0; u < x.shape.width; ++u) {
        double numerator = 0;
        double magnitude = 0;
        double denominator = 0;
        double sum = 0;
        const float* w = weights.weight.data() + o * layer.inputs * layer.size * layer.size;
        for (int i = 0; i < layer.inputs; ++i) {
          for (int dv = -reach; dv <= reach; ++dv) {
            for (int du = -reach; du <= reach; ++du, ++w) {
              const double value = x.padded(padding, i, v + dv, u + du);
              const double confidence = c.padded(padding, i, v + dv, u + du);
              numerator += *w * (value * confidence);
              magnitude += std::abs(*w * value * confidence);
              denominator += *w * confidence;
              sum += *w;
            }
          }
        }
        const double mean = numerator / (denominator + 1e-20);
        expected.y.at(o, v, u) = mean + weights.bias[o];
        expected.c.at(o, v, u) = denominator / sum;
        expected.y_bound.at(o, v, u) =
            roundings * (2 * magnitude / (denominator + 1e-20) + std::abs(weights.bias[o]));
        expected.c_bound.at(o, v, u) = roundings * denominator / sum;
      }
    }
  }
  return expected;
}

// A third of the pixels are known.
PlainImage SparseConfidence(const Shape& shape) {
  PlainImage c = RandomImage(shape, -2.0f, 1.0f, 9);
  for (double& value : c.values) value = std::max(value, 0.0);
  return c;
}

void ExpectAsExpected(const Layer& layer, Padding padding, const PlainImage& x,
                      const PlainImage& c) {
  const Weights weights(layer);
  const Expected expected = Reference(weights, layer, padding, x, c);
  const NormalizedConvolution kernel = weights.Kernel(layer, padding);
  const FilledTensor input(x, Layout::kPlanar, 0);
  const FilledTensor confidence(c, Layout::kPlanar, 0);
  const TensorFormat format{expected.y.shape, Layout::kPlanar, DataType::kFloat, 0};
  const TensorMemory y(format);
  const TensorMemory y_confidence(format);
  RunSingle(kernel, input.view, confidence.view, y.view, y_confidence.view, 1);
  ExpectNear(y.view, expected.y, expected.y_bound);
  ExpectNear(y_confidence.view, expected.c, expected.c_bound);
  const TensorMemory other_y(format);
  const TensorMemory other_confidence(format);
  RunSingle(kernel, input.view, confidence.view, other_y.view, other_confidence.view, 2);
  ExpectSameBits(other_y.view, y.view);
  ExpectSameBits(other_confidence.view, y_confidence.view);
}

TEST(NormalizedConvolution, IsTheWeightedMeanForEverySizePaddingAndInstructionSet) {
  ForEachDispatchTarget([] {
    for (const Layer& layer : kLayers) {
      for (const Padding padding : kPaddings) {
        for (const auto& [rows, columns] :
             {std::pair{1, 1}, {1, 2}, {2, 1}, {7, 6}, {5, 33}, {37, 160}, {3, 601}}) {
          if (padding == Padding::kWrapCrossPole && columns % 2 != 0) continue;
          SCOPED_TRACE(testing::Message() << layer.inputs << " to " << layer.outputs << ", kernel "
                                          << layer.size << ", padding " << static_cast<int>(padding)
                                          << ", " << rows << " x " << columns);
          const Shape shape{layer.inputs, rows, columns};
          ExpectAsExpected(layer, padding, RandomImage(shape, -3.0f, 3.0f, 7),
                           SparseConfidence(shape));
        }
      }
    }
  });
}

TEST(NormalizedConvolution, GivesTheBiasAndNoConfidenceWhereNothingIsKnown) {
  ForEachDispatchTarget([] {
    for (const Layer& layer : kLayers) {
      const Shape shape{layer.inputs, 4, 18};
      const Weights weights(layer);
      const NormalizedConvolution kernel = weights.Kernel(layer, Padding::kWrapReplicate);
      const FilledTensor x(RandomImage(shape, -3.0f, 3.0f, 7), Layout::kPlanar, 0);
      const FilledTensor c(PlainImage(shape), Layout::kPlanar, 0);
      const TensorFormat format{{layer.outputs, 4, 18}, Layout::kPlanar, DataType::kFloat, 0};
      const TensorMemory y(format);
      const TensorMemory y_confidence(format);
      RunSingle(kernel, x.view, c.view, y.view, y_confidence.view, 1);
      PlainImage bias(format.shape);
      for (int i = 0; i < static_cast<int>(bias.values.size()); ++i) {
        bias.values[i] = weights.bias[i / (4 * 18)];
      }
      ExpectEqual(y.view, bias);
      ExpectEqual(y_confidence.view, PlainImage(format.shape));
    }
  });
}

TEST(NormalizedConvolution, SpreadsWhatIsNotANumberAsFarAsTheWindow) {
  ForEachDispatchTarget([] {
    for (const Layer& layer : kLayers) {
      const int reach = layer.size / 2;
      for (const float bad :
           {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const Shape shape{layer.inputs, 9, 40};
        PlainImage x = RandomImage(shape, -3.0f, 3.0f, 7);
        PlainImage c = SparseConfidence(shape);
        const int column = 20;
        const int row = 4;
        x.at(layer.inputs - 1, row, column) = bad;
        c.at(layer.inputs - 1, row, column) = 0;
        const Weights weights(layer);
        const NormalizedConvolution kernel = weights.Kernel(layer, Padding::kZero);
        const FilledTensor input(x, Layout::kPlanar, 0);
        const FilledTensor confidence(c, Layout::kPlanar, 0);
        const TensorFormat format{{layer.outputs, 9, 40}, Layout::kPlanar, DataType::kFloat, 0};
        const TensorMemory y(format);
        const TensorMemory y_confidence(format);
        RunSingle(kernel, input.view, confidence.view, y.view, y_confidence.view, 1);
        for (int o = 0; o < layer.outputs; ++o) {
          for (int v = 0; v < 9; ++v) {
            for (int u = 0; u < 40; ++u) {
              const bool reached = std::abs(v - row) <= reach && std::abs(u - column) <= reach;
              ASSERT_EQ(std::isnan(At(y.view, o, v, u)), reached) << v << ' ' << u;
              ASSERT_TRUE(std::isfinite(At(y_confidence.view, o, v, u)));
            }
          }
        }
      }
    }
  });
}

// Log depth of a scene k times as large is larger by ln k everywhere, and so is the result.
TEST(NormalizedConvolution, IsEquivariantToAnOffset) {
  const Layer layer{2, 2, 5};
  const Shape shape{2, 20, 64};
  const NormalizedConvolution kernel = Weights(layer).Kernel(layer, Padding::kWrapReplicate);
  const PlainImage x = RandomImage(shape, -3.0f, 3.0f, 7);
  const FilledTensor c(SparseConfidence(shape), Layout::kPlanar, 0);
  PlainImage shifted = x;
  const double offset = 2.5;
  for (double& value : shifted.values) value = static_cast<float>(value + offset);
  const FilledTensor first(x, Layout::kPlanar, 0);
  const FilledTensor second(shifted, Layout::kPlanar, 0);
  const TensorFormat format{shape, Layout::kPlanar, DataType::kFloat, 0};
  const TensorMemory y(format);
  const TensorMemory shifted_y(format);
  const TensorMemory y_confidence(format);
  RunSingle(kernel, first.view, c.view, y.view, y_confidence.view, 1);
  RunSingle(kernel, second.view, c.view, shifted_y.view, y_confidence.view, 1);
  PlainImage expected(shape);
  PlainImage tolerance(shape);
  for (int o = 0; o < 2; ++o) {
    for (int v = 0; v < 20; ++v) {
      for (int u = 0; u < 64; ++u) {
        const bool known = At(y_confidence.view, o, v, u) > 0;
        expected.at(o, v, u) = At(y.view, o, v, u) + (known ? offset : 0);
        tolerance.at(o, v, u) = 2 * (50 + 4) * kEpsilon * (5.5 + 3 + 0.5);
      }
    }
  }
  ExpectNear(shifted_y.view, expected, tolerance);
}

// What a chain must give: every layer by itself, with inputs up-sampled and concatenated before.
TEST(NormalizedChain, GivesTheBitsOfItsLayersForAnyNumberOfThreads) {
  constexpr Layer kChain[] = {{2, 4, 3}, {2, 2, 5}, {3, 2, 7}, {2, 3, 1}, {2, 2, 5}, {1, 2, 1}};
  ForEachDispatchTarget([&] {
    for (const Padding padding : kPaddings) {
      for (const auto& [rows, columns] : {std::pair{2, 2}, {4, 6}, {14, 34}, {64, 18}, {66, 128}}) {
        SCOPED_TRACE(testing::Message() << "padding " << static_cast<int>(padding) << ", " << rows
                                        << " x " << columns);
        std::vector<NormalizedConvolution> layers;
        for (const Layer& layer : kChain) layers.push_back(Weights(layer).Kernel(layer, padding));
        const NormalizedChain chain(layers);

        const Shape half{2, rows / 2, columns / 2};
        const Shape whole{2, rows, columns};
        const FilledTensor low_x(RandomImage(half, -3.0f, 3.0f, 1), Layout::kPlanar, 0);
        const FilledTensor low_c(SparseConfidence(half), Layout::kPlanar, 1);
        const FilledTensor high_x(RandomImage(whole, -3.0f, 3.0f, 2), Layout::kPlanar, 2);
        const FilledTensor high_c(SparseConfidence(whole), Layout::kPlanar, 0);

        const TensorFormat concatenated{{4, rows, columns}, Layout::kPlanar, DataType::kFloat, 0};
        auto x = std::make_unique<TensorMemory>(concatenated);
        auto c = std::make_unique<TensorMemory>(concatenated);
        UpsampleNearest(low_x.view, ChannelSlice(x->view, 0, 2), 1);
        UpsampleNearest(low_c.view, ChannelSlice(c->view, 0, 2), 1);
        Reorder(high_x.view, ChannelSlice(x->view, 2, 2));
        Reorder(high_c.view, ChannelSlice(c->view, 2, 2));
        for (const NormalizedConvolution& layer : layers) {
          const TensorFormat format{
              {layer.outputs(), rows, columns}, Layout::kPlanar, DataType::kFloat, 0};
          auto next_x = std::make_unique<TensorMemory>(format);
          auto next_c = std::make_unique<TensorMemory>(format);
          RunSingle(layer, x->view, c->view, next_x->view, next_c->view, 1);
          x = std::move(next_x);
          c = std::move(next_c);
        }

        const NormalizedInput inputs[] = {{{low_x.view, low_c.view}, true},
                                          {{high_x.view, high_c.view}, false}};
        for (const int threads : {1, 2, 4}) {
          const TensorFormat format{{1, rows, columns}, Layout::kPlanar, DataType::kFloat, 0};
          const TensorMemory y(format);
          const TensorMemory y_confidence(format);
          const TensorMemory small_y({{1, rows / 2, columns / 2}, Layout::kPlanar});
          const TensorMemory small_c({{1, rows / 2, columns / 2}, Layout::kPlanar});
          const Scratch scratch(chain.ScratchBytes(columns, threads));
          const PooledOutput pooled{{small_y.view, small_c.view}, ConfidenceRule::kQuarter};
          chain.Run(inputs, {y.view, y_confidence.view}, scratch.bytes, threads, &pooled);
          ExpectSameBits(y.view, x->view);
          ExpectSameBits(y_confidence.view, c->view);
          const TensorMemory pooled_y({{1, rows / 2, columns / 2}, Layout::kPlanar});
          const TensorMemory pooled_c({{1, rows / 2, columns / 2}, Layout::kPlanar});
          ConfidencePool(x->view, c->view, pooled_y.view, pooled_c.view, pooled.rule, 1);
          ExpectSameBits(small_y.view, pooled_y.view);
          ExpectSameBits(small_c.view, pooled_c.view);
        }
      }
    }
  });
}

TEST(NormalizedConvolution, RefusesWeightsAndTensorsThatDoNotFit) {
  const std::vector<float> weight(2 * 3 * 3 * 3, 1.0f);
  const std::vector<float> bias(2);
  EXPECT_THROW(NormalizedConvolution(weight, bias, 2, 3, 2, Padding::kZero), ContractError);
  EXPECT_THROW(NormalizedConvolution(weight, bias, 2, 2, 3, Padding::kZero), ContractError);
  EXPECT_THROW(NormalizedConvolution(weight, weight, 2, 3, 3, Padding::kZero), ContractError);
}

TEST(NormalizedChain, RefusesTensorsThatDoNotFit) {
  const Layer layer{2, 3, 3};
  const NormalizedChain chain({Weights(layer).Kernel(layer, Padding::kWrapCrossPole)});
  const TensorMemory three({{3, 4, 4}, Layout::kPlanar, DataType::kFloat, 1});
  const TensorMemory two({{2, 4, 4}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory large({{2, 8, 8}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory blocked({{2, 4, 4}, Layout::kBlocked, DataType::kFloat, 0});
  const TensorMemory odd_in({{3, 4, 5}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory odd_out({{2, 4, 5}, Layout::kPlanar, DataType::kFloat, 0});
  const Scratch scratch(chain.ScratchBytes(8, 1));
  const auto run = [&](const TensorMemory& in, bool doubled, const TensorMemory& out) {
    const NormalizedInput input{{in.view, in.view}, doubled};
    chain.Run({&input, 1}, {out.view, out.view}, scratch.bytes, 1);
  };
  run(three, false, two);
  run(three, true, large);
  EXPECT_THROW(run(two, false, two), ContractError);
  EXPECT_THROW(run(three, true, two), ContractError);
  EXPECT_THROW(run(three, false, large), ContractError);
  EXPECT_THROW(run(three, false, blocked), ContractError);
  EXPECT_THROW(run(odd_in, false, odd_out), ContractError);
  const NormalizedInput input{{three.view, three.view}};
  EXPECT_THROW(chain.Run({&input, 1}, {two.view, two.view}, scratch.bytes.first(64), 1),
               ContractError);
  const PooledOutput pooled{{two.view, two.view}, ConfidenceRule::kQuarter};
  EXPECT_THROW(chain.Run({&input, 1}, {two.view, two.view}, scratch.bytes, 1, &pooled),
               ContractError);
  EXPECT_THROW(chain.Run({}, {two.view, two.view}, scratch.bytes, 1), ContractError);
}

TEST(NormalizedChain, RefusesLayersThatDoNotFit) {
  const NormalizedConvolution first = Weights({2, 1, 3}).Kernel({2, 1, 3}, Padding::kZero);
  const NormalizedConvolution second = Weights({1, 3, 3}).Kernel({1, 3, 3}, Padding::kZero);
  EXPECT_THROW(NormalizedChain({}), ContractError);
  EXPECT_THROW(NormalizedChain({first, second}), ContractError);
}

}  // namespace
}  // namespace orb360::nn
