#include "tests/nn/reference_interpreter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace orb360::nn {
namespace {

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

class Interpreter {
 public:
  Interpreter(const Graph& graph, const Node& node, const std::vector<const PlainImage*>& inputs)
      : graph_(graph), node_(node), inputs_(inputs) {}

  NodeResult operator()(const NormalizedConvolutionOp& op) const {
    const Weight& weight = this->weight(0);
    NodeResult result = Make({channels_of(weight), x().height, x().width}, 2);
    ForEach(result.outputs[0].shape, [&](int o, int v, int u) {
      double numerator = 0, denominator = 0, magnitude = 0, sum = 0;
      ForEachTap(weight, [&](int i, int dv, int du, std::size_t tap) {
        const double w = weight.values[Index(o) * taps_of(weight) + tap];
        const double value = in(0).padded(op.padding, i, v + dv, u + du);
        const double confidence = in(1).padded(op.padding, i, v + dv, u + du);
        numerator += w * value * confidence;
        magnitude += std::abs(w * value * confidence);
        denominator += w * confidence;
        sum += w;
      });
      const double bias = this->weight(1).values[Index(o)];
      Set(&result, 0, o, v, u, numerator / (denominator + 1e-20) + bias,
          magnitude / (denominator + 1e-20) + std::abs(bias));
      Set(&result, 1, o, v, u, denominator / sum, denominator / sum);
    });
    return result;
  }
  NodeResult operator()(const ConfidencePoolOp& op) const {
    NodeResult result = Make({x().channels, x().height / 2, x().width / 2}, 2);
    ForEach(result.outputs[0].shape, [&](int channel, int v, int u) {
      int best_v = 2 * v, best_u = 2 * u;
      for (int i = 1; i < 4; ++i) {
        const int row = 2 * v + i / 2, column = 2 * u + i % 2;
        if (in(1).at(channel, row, column) > in(1).at(channel, best_v, best_u)) {
          best_v = row;
          best_u = column;
        }
      }
      const double confidence = in(1).at(channel, best_v, best_u);
      Set(&result, 0, channel, v, u, in(0).at(channel, best_v, best_u));
      Set(&result, 1, channel, v, u,
          op.rule == ConfidencePoolOp::Rule::kQuarter ? confidence / 4 : std::sqrt(confidence));
    });
    return result;
  }
  NodeResult operator()(const ConvolutionOp& op) const {
    const Weight& weight = this->weight(0);
    NodeResult result = Make({channels_of(weight), (x().height + op.stride - 1) / op.stride,
                              (x().width + op.stride - 1) / op.stride},
                             1);
    ForEach(result.outputs[0].shape, [&](int o, int v, int u) {
      double sum = this->weight(1).values[Index(o)];
      double magnitude = std::abs(sum);
      ForEachTap(weight, [&](int i, int dv, int du, std::size_t tap) {
        const double term = weight.values[Index(o) * taps_of(weight) + tap] *
                            in(0).padded(op.padding, i, op.stride * v + dv, op.stride * u + du);
        sum += term;
        magnitude += std::abs(term);
      });
      Set(&result, 0, o, v, u, sum, magnitude);
    });
    return result;
  }
  NodeResult operator()(const DenseOp&) const {
    const Weight& weight = this->weight(0);
    NodeResult result = Make({weight.shape[0], 1, 1}, 1);
    for (int o = 0; o < weight.shape[0]; ++o) {
      double sum = this->weight(1).values[Index(o)];
      double magnitude = std::abs(sum);
      for (int i = 0; i < weight.shape[1]; ++i) {
        const double term = weight.values[Index(o * weight.shape[1] + i)] * in(0).at(i, 0, 0);
        sum += term;
        magnitude += std::abs(term);
      }
      Set(&result, 0, o, 0, 0, sum, magnitude);
    }
    return result;
  }
  NodeResult operator()(const UpsampleNearestOp&) const {
    NodeResult result = Make({x().channels, 2 * x().height, 2 * x().width}, 1);
    ForEach(result.outputs[0].shape, [&](int channel, int v, int u) {
      Set(&result, 0, channel, v, u, in(0).at(channel, v / 2, u / 2));
    });
    return result;
  }
  NodeResult operator()(const UpsampleBilinearOp& op) const {
    NodeResult result = Make({x().channels, 2 * x().height, 2 * x().width}, 1);
    ForEach(result.outputs[0].shape, [&](int channel, int v, int u) {
      const double row = (v + 0.5) / 2 - 0.5, column = (u + 0.5) / 2 - 0.5;
      const auto top = static_cast<int>(std::floor(row));
      const auto left = static_cast<int>(std::floor(column));
      double sum = 0, magnitude = 0;
      for (int i = 0; i < 4; ++i) {
        const int below = i / 2;
        const int right = i % 2;
        const double fraction =
            std::abs(1 - below - (row - top)) * std::abs(1 - right - (column - left));
        const double term = fraction * in(0).padded(op.padding, channel, top + below, left + right);
        sum += term;
        magnitude += std::abs(term);
      }
      Set(&result, 0, channel, v, u, sum, magnitude);
    });
    return result;
  }
  NodeResult operator()(const ConvexUpsampleOp& op) const {
    const int f = op.factor;
    NodeResult result = Make({1, f * x().height, f * x().width}, 1);
    ForEach(result.outputs[0].shape, [&](int, int v, int u) {
      const int first = 9 * (f * (v % f) + u % f);
      double largest = -HUGE_VAL, total = 0, sum = 0, magnitude = 0;
      for (int i = 0; i < 9; ++i) largest = std::max(largest, in(1).at(first + i, v / f, u / f));
      for (int i = 0; i < 9; ++i) {
        const double fraction = std::exp(in(1).at(first + i, v / f, u / f) - largest);
        const double value = in(0).padded(op.padding, 0, v / f + i / 3 - 1, u / f + i % 3 - 1);
        total += fraction;
        sum += fraction * value;
        magnitude += fraction * std::abs(value);
      }
      Set(&result, 0, 0, v, u, sum / total, magnitude / total);
    });
    return result;
  }
  NodeResult operator()(const AveragePoolOp&) const {
    NodeResult result = Make({x().channels, x().height / 2, x().width / 2}, 1);
    ForEach(result.outputs[0].shape, [&](int channel, int v, int u) {
      double sum = 0, magnitude = 0;
      for (int i = 0; i < 4; ++i) {
        const double value = in(0).at(channel, 2 * v + i / 2, 2 * u + i % 2);
        sum += value / 4;
        magnitude += std::abs(value) / 4;
      }
      Set(&result, 0, channel, v, u, sum, magnitude);
    });
    return result;
  }
  NodeResult operator()(const GlobalAveragePoolOp&) const {
    NodeResult result = Make({x().channels, 1, 1}, 1);
    const double pixels = static_cast<double>(x().height) * x().width;
    for (int channel = 0; channel < x().channels; ++channel) {
      double sum = 0, magnitude = 0;
      ForEach({1, x().height, x().width}, [&](int, int v, int u) {
        sum += in(0).at(channel, v, u);
        magnitude += std::abs(in(0).at(channel, v, u));
      });
      Set(&result, 0, channel, 0, 0, sum / pixels, magnitude / pixels);
    }
    return result;
  }
  NodeResult operator()(const ReluOp&) const {
    return Elementwise([](double value) { return value < 0 ? 0 : value; });
  }
  NodeResult operator()(const TanhOp&) const {
    return Elementwise([](double value) { return std::tanh(value); });
  }
  NodeResult operator()(const SigmoidOp&) const {
    return Elementwise([](double value) { return 1 / (1 + std::exp(-value)); });
  }
  NodeResult operator()(const SoftplusOp&) const {
    return Elementwise(
        [](double value) { return std::max(value, 0.0) + std::log1p(std::exp(-std::abs(value))); });
  }
  NodeResult operator()(const ExpOp&) const {
    return Elementwise([](double value) { return std::exp(value); });
  }
  NodeResult operator()(const LogOp&) const {
    return Elementwise([](double value) { return std::log(value); });
  }
  NodeResult operator()(const LeakyReluOp& op) const {
    return Elementwise([&](double value) { return value < 0 ? op.slope * value : value; });
  }
  NodeResult operator()(const ClampOp& op) const {
    return Elementwise([&](double value) {
      return std::min<double>(std::max<double>(value, op.minimum), op.maximum);
    });
  }
  NodeResult operator()(const AffineOp& op) const {
    NodeResult result = Elementwise([&](double value) { return op.scale * value + op.offset; });
    ForEach(x(), [&](int channel, int v, int u) {
      result.magnitudes[0].at(channel, v, u) =
          std::abs(op.scale * in(0).at(channel, v, u)) + std::abs(op.offset);
    });
    return result;
  }
  NodeResult operator()(const AddOp&) const {
    NodeResult result = Make(x(), 1);
    ForEach(x(), [&](int channel, int v, int u) {
      const double a = in(0).at(channel, v, u), b = in(1).at(channel, v, u);
      Set(&result, 0, channel, v, u, a + b, std::abs(a) + std::abs(b));
    });
    return result;
  }
  NodeResult operator()(const MultiplyOp&) const {
    NodeResult result = Make(x(), 1);
    ForEach(x(), [&](int channel, int v, int u) {
      Set(&result, 0, channel, v, u, in(0).at(channel, v, u) * in(1).at(channel, v, u));
    });
    return result;
  }
  NodeResult operator()(const ConcatenateOp&) const {
    int channels = 0;
    for (const PlainImage* input : inputs_) channels += input->shape.channels;
    NodeResult result = Make({channels, x().height, x().width}, 1);
    int first = 0;
    for (const PlainImage* input : inputs_) {
      ForEach(input->shape, [&](int channel, int v, int u) {
        Set(&result, 0, first + channel, v, u, input->at(channel, v, u));
      });
      first += input->shape.channels;
    }
    return result;
  }
  NodeResult operator()(const SliceOp& op) const {
    NodeResult result = Make({op.count, x().height, x().width}, 1);
    ForEach(result.outputs[0].shape, [&](int channel, int v, int u) {
      Set(&result, 0, channel, v, u, in(0).at(op.first + channel, v, u));
    });
    return result;
  }
  NodeResult operator()(const MedianLogOp&) const {
    NodeResult result = Make(x(), 2);
    const auto is_point = [&](int v, int u) {
      const double depth = in(0).at(0, v, u);
      return std::isfinite(depth) && depth > 0 && in(1).at(0, v, u) > 0;
    };
    std::vector<double> depths;
    ForEach(x(), [&](int, int v, int u) {
      if (is_point(v, u)) depths.push_back(in(0).at(0, v, u));
    });
    std::ranges::sort(depths);
    const double median = depths.empty() ? 1 : depths[(depths.size() - 1) / 2];
    ForEach(x(), [&](int, int v, int u) {
      if (!is_point(v, u)) return;
      Set(&result, 0, 0, v, u, std::log(in(0).at(0, v, u) / median));
      Set(&result, 1, 0, v, u, std::min(in(1).at(0, v, u), 1.0));
    });
    result.outputs.emplace_back(Shape{1, 1, 1});
    result.magnitudes.emplace_back(Shape{1, 1, 1});
    Set(&result, 2, 0, 0, 0, median);
    return result;
  }
  NodeResult operator()(const LatitudeSineOp&) const {
    NodeResult result = Make({1, x().height, x().width}, 1);
    constexpr double kPi = std::numbers::pi;
    ForEach(result.outputs[0].shape, [&](int, int v, int u) {
      Set(&result, 0, 0, v, u, std::sin(kPi / 2 - kPi * (v + 0.5) / x().height), 1);
    });
    return result;
  }

 private:
  const PlainImage& in(std::size_t i) const { return *inputs_[i]; }
  const Shape& x() const { return inputs_[0]->shape; }
  const Weight& weight(std::size_t i) const { return graph_.weights[Index(node_.weights[i])]; }
  static int channels_of(const Weight& weight) { return weight.shape[0]; }
  static std::size_t taps_of(const Weight& weight) {
    return weight.values.size() / Index(weight.shape[0]);
  }

  static NodeResult Make(const Shape& shape, std::size_t outputs) {
    return {std::vector<PlainImage>(outputs, PlainImage(shape)),
            std::vector<PlainImage>(outputs, PlainImage(shape))};
  }
  static void Set(NodeResult* result, std::size_t output, int channel, int v, int u, double value,
                  double magnitude = 0) {
    result->outputs[output].at(channel, v, u) = value;
    result->magnitudes[output].at(channel, v, u) = std::max(magnitude, std::abs(value));
  }
  static void ForEach(const Shape& shape, const std::function<void(int, int, int)>& visit) {
    for (int channel = 0; channel < shape.channels; ++channel) {
      for (int v = 0; v < shape.height; ++v) {
        for (int u = 0; u < shape.width; ++u) visit(channel, v, u);
      }
    }
  }
  /// Input channel, row and column from the centre, place in an output channel's weights.
  template <typename Visit>
  static void ForEachTap(const Weight& weight, const Visit& visit) {
    const int size = weight.shape[3];
    std::size_t tap = 0;
    for (int i = 0; i < weight.shape[1]; ++i) {
      for (int dv = -(size / 2); dv <= size / 2; ++dv) {
        for (int du = -(size / 2); du <= size / 2; ++du) visit(i, dv, du, tap++);
      }
    }
  }
  NodeResult Elementwise(const std::function<double(double)>& function) const {
    NodeResult result = Make(x(), 1);
    ForEach(x(), [&](int channel, int v, int u) {
      Set(&result, 0, channel, v, u, function(in(0).at(channel, v, u)));
    });
    return result;
  }

  const Graph& graph_;
  const Node& node_;
  const std::vector<const PlainImage*>& inputs_;
};

}  // namespace

NodeResult InterpretNode(const Graph& graph, const Node& node,
                         const std::vector<const PlainImage*>& inputs) {
  return std::visit(Interpreter(graph, node, inputs), node.operation);
}

std::map<std::string, PlainImage> Interpret(const Graph& graph,
                                            const std::vector<PlainImage>& inputs) {
  std::map<std::string, PlainImage> tensors;
  const auto name = [&](int tensor) { return graph.tensors[Index(tensor)].name; };
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    tensors.insert_or_assign(name(graph.inputs[i]), inputs[i]);
  }
  for (const Node& node : graph.nodes) {
    std::vector<const PlainImage*> read;
    for (const int tensor : node.inputs) read.push_back(&tensors.at(name(tensor)));
    NodeResult result = InterpretNode(graph, node, read);
    for (std::size_t i = 0; i < node.outputs.size(); ++i) {
      tensors.insert_or_assign(name(node.outputs[i]), std::move(result.outputs[i]));
    }
  }
  return tensors;
}

}  // namespace orb360::nn
