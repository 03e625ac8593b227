#include "nn/graph/shape_inference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "nn/graph/limits.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

std::string ToText(const std::vector<int>& shape) {
  std::string text;
  for (const int size : shape) {
    if (!text.empty()) text += "x";
    text += std::to_string(size);
  }
  return text;
}

std::string ToText(const Extent& extent) {
  if (extent.is_single) return "1x1";
  if (extent.halvings == 0) return "the image's size";
  return extent.halvings > 0 ? "1/" + std::to_string(1 << extent.halvings) + " of the image's size"
                             : std::to_string(1 << -extent.halvings) + " times the image's size";
}

class Inference {
 public:
  Inference(const Graph& graph, const Node& node) : graph_(graph), node_(node) {}

  std::vector<Tensor> operator()(const NormalizedConvolutionOp& op) const {
    RequireSameShape();
    RequirePadding(op.padding);
    const Weight& weight = RequireKernel(limits::kKernelSize);
    RequireConfidenceWeights(weight);
    const Tensor output = Make(weight.shape[0], input(0).extent);
    return {output, output};
  }
  std::vector<Tensor> operator()(const ConfidencePoolOp&) const {
    RequireSameShape();
    const Tensor output = Make(input(0).channels, Half());
    return {output, output};
  }
  std::vector<Tensor> operator()(const ConvolutionOp& op) const {
    RequirePadding(op.padding);
    constexpr int kLargestKernel = 5;
    const Weight& weight = RequireKernel(kLargestKernel);
    Extent extent = input(0).extent;
    if (op.stride == 2 && !extent.is_single) extent = Halved(extent);
    return {Make(weight.shape[0], extent)};
  }
  std::vector<Tensor> operator()(const DenseOp&) const {
    if (!input(0).extent.is_single) Refuse(Describe(0) + ", and dense takes 1x1 only");
    const Weight& weight = this->weight(0);
    if (weight.shape.size() != 2 || weight.shape[1] != input(0).channels) {
      Refuse("weights \"" + weight.name + "\" are " + ToText(weight.shape) + " and should be Ox" +
             std::to_string(input(0).channels));
    }
    RequireBias(weight.shape[0]);
    return {Make(weight.shape[0], input(0).extent)};
  }
  std::vector<Tensor> operator()(const UpsampleNearestOp&) const {
    return {Make(input(0).channels, Double())};
  }
  std::vector<Tensor> operator()(const UpsampleBilinearOp& op) const {
    RequirePadding(op.padding);
    return {Make(input(0).channels, Double())};
  }
  std::vector<Tensor> operator()(const ConvexUpsampleOp& op) const {
    RequirePadding(op.padding);
    RequireChannels(0, 1);
    RequireChannels(1, 9 * op.factor * op.factor);  // 3x3 neighbours of each pixel of the output
    if (input(0).extent != input(1).extent) Refuse(Describe(0) + ", but " + Describe(1));
    return {Make(1, op.factor == 2 ? Double() : input(0).extent)};
  }
  std::vector<Tensor> operator()(const AveragePoolOp&) const {
    return {Make(input(0).channels, Half())};
  }
  std::vector<Tensor> operator()(const GlobalAveragePoolOp&) const {
    return {Make(input(0).channels, {.is_single = true})};
  }
  std::vector<Tensor> operator()(const ClampOp& op) const {
    if (op.minimum > op.maximum) Refuse("minimum is above maximum");
    return {Make(input(0).channels, input(0).extent)};
  }
  std::vector<Tensor> operator()(const AddOp&) const {
    RequireSameShape();
    return {Make(input(0).channels, input(0).extent)};
  }
  std::vector<Tensor> operator()(const MultiplyOp&) const {
    RequireSameShape();
    return {Make(input(0).channels, input(0).extent)};
  }
  std::vector<Tensor> operator()(const ConcatenateOp&) const {
    std::size_t channels = 0;
    for (std::size_t i = 0; i < node_.inputs.size(); ++i) {
      channels += static_cast<std::size_t>(input(i).channels);
      if (input(i).extent != input(0).extent) Refuse(Describe(0) + ", but " + Describe(i));
    }
    if (channels > limits::kChannels) {
      Refuse("its " + std::to_string(channels) + " channels are more than " +
             std::to_string(limits::kChannels));
    }
    return {Make(static_cast<int>(channels), input(0).extent)};
  }
  std::vector<Tensor> operator()(const SliceOp& op) const {
    const int channels = input(0).channels;
    if (op.first >= channels || op.count > channels - op.first) {
      Refuse("channels " + std::to_string(op.first) + " to " +
             std::to_string(std::int64_t{op.first} + op.count - 1) +
             " do not exist: " + Describe(0));
    }
    return {Make(op.count, input(0).extent)};
  }
  std::vector<Tensor> operator()(const MedianLogOp&) const {
    RequireChannels(0, 1);
    RequireSameShape();
    const Tensor output = Make(1, input(0).extent);
    return {output, output, Make(1, {.is_single = true})};
  }
  std::vector<Tensor> operator()(const LatitudeSineOp&) const { return {Make(1, input(0).extent)}; }
  /// Element-wise functions of one tensor.
  template <typename Elementwise>
  std::vector<Tensor> operator()(const Elementwise&) const {
    return {Make(input(0).channels, input(0).extent)};
  }

 private:
  [[noreturn]] static void Refuse(const std::string& reason) { throw UserError(reason); }

  static Tensor Make(int channels, const Extent& extent) { return {{}, channels, extent}; }

  const Tensor& input(std::size_t i) const {
    return graph_.tensors[static_cast<std::size_t>(node_.inputs[i])];
  }
  const Weight& weight(std::size_t i) const {
    return graph_.weights[static_cast<std::size_t>(node_.weights[i])];
  }
  std::string Describe(std::size_t i) const {
    return "\"" + input(i).name + "\" has " + std::to_string(input(i).channels) + " channels at " +
           ToText(input(i).extent);
  }

  /// Returns true if the tensor's sides are multiples of `divisor` (a power of two) for every image
  /// size.
  bool IsMultipleOf(const Extent& extent, int divisor) const {
    if (extent.is_single) return divisor == 1;
    const int halvings = extent.halvings;
    const int sides = halvings < 0 ? graph_.size_multiple << -halvings : graph_.size_multiple;
    return sides % (divisor << std::max(halvings, 0)) == 0;
  }
  Extent Halved(Extent extent) const {
    if (++extent.halvings > limits::kMaxHalvings) {
      Refuse("its result would be " + ToText(extent) + ", which is too small");
    }
    return extent;
  }
  Extent Half() const {
    const Extent extent = input(0).extent;
    if (extent.is_single) Refuse(Describe(0) + ", which has no half");
    if (!IsMultipleOf(extent, 2)) {
      Refuse(Describe(0) + ", which is odd for some multiples of size_multiple; size_multiple " +
             "must be a multiple of " + std::to_string(2 << std::max(extent.halvings, 0)));
    }
    return Halved(extent);
  }
  Extent Double() const {
    Extent extent = input(0).extent;
    if (extent.is_single) Refuse(Describe(0) + ", which is not up-sampled");
    if (!IsMultipleOf(extent, 1)) {
      Refuse(Describe(0) + ", rounded up for some multiples of size_multiple; size_multiple must " +
             "be a multiple of " + std::to_string(1 << std::max(extent.halvings, 0)));
    }
    if (--extent.halvings < limits::kLeastHalvings) {
      Refuse("its result would be " + ToText(extent) + ", which is too large");
    }
    return extent;
  }

  void RequireChannels(std::size_t i, int channels) const {
    if (input(i).channels != channels) {
      Refuse(Describe(i) + " and should have " + std::to_string(channels));
    }
  }
  void RequireSameShape() const {
    if (input(0).channels != input(1).channels || input(0).extent != input(1).extent) {
      Refuse(Describe(0) + ", but " + Describe(1));
    }
  }
  void RequirePadding(Padding padding) const {
    if (padding == Padding::kWrapCrossPole && !IsMultipleOf(input(0).extent, 2)) {
      Refuse("wrap_cross_pole needs an even width, and " + Describe(0));
    }
  }
  const Weight& RequireKernel(int largest) const {
    const Weight& kernel = weight(0);
    const std::vector<int>& shape = kernel.shape;
    const bool is_kernel = shape.size() == 4 && shape[1] == input(0).channels &&
                           shape[2] == shape[3] && shape[3] % 2 == 1 && shape[3] <= largest;
    if (!is_kernel) {
      Refuse("weights \"" + kernel.name + "\" are " + ToText(shape) + " and should be Ox" +
             std::to_string(input(0).channels) + "xKxK with K odd and at most " +
             std::to_string(largest));
    }
    RequireBias(shape[0]);
    return kernel;
  }
  void RequireBias(int outputs) const {
    if (outputs > limits::kChannels) {
      Refuse("its " + std::to_string(outputs) + " channels are more than " +
             std::to_string(limits::kChannels));
    }
    if (weight(1).shape != std::vector<int>{outputs}) {
      Refuse("weights \"" + weight(1).name + "\" are " + ToText(weight(1).shape) +
             " and should be " + std::to_string(outputs));
    }
  }
  /// Negative weights of confidences, or a sum by which one cannot divide, would silently give
  /// meaningless results.
  static void RequireConfidenceWeights(const Weight& weight) {
    const auto per_output = static_cast<std::ptrdiff_t>(weight.values.size()) / weight.shape[0];
    for (auto begin = weight.values.begin(); begin != weight.values.end(); begin += per_output) {
      double sum = 0;
      for (auto value = begin; value != begin + per_output; ++value) {
        if (!(*value >= 0)) {
          Refuse("weights \"" + weight.name +
                 "\" of a normalized convolution are negative: " + std::to_string(*value));
        }
        sum += *value;
      }
      constexpr double kSmallest = std::numeric_limits<float>::min();
      constexpr double kLargest = std::numeric_limits<float>::max();
      if (!(sum >= kSmallest && sum <= kLargest)) {
        Refuse("weights \"" + weight.name + "\" of an output channel add up to " +
               (sum < 1 ? "zero" : "infinity"));
      }
    }
  }

  const Graph& graph_;
  const Node& node_;
};

}  // namespace

std::vector<Tensor> InferOutputs(const Graph& graph, const Node& node) {
  return std::visit(Inference(graph, node), node.operation);
}

}  // namespace orb360::nn
