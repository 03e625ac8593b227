#include <array>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {
namespace {

int Scaled(int size, int halvings) {
  if (halvings < 0) return size << -halvings;
  return (size + (1 << halvings) - 1) >> halvings;
}

}  // namespace

const char* NameOf(const Operation& operation) {
  // The order is that of the variant's alternatives.
  static constexpr std::array<const char*, std::variant_size_v<Operation>> kNames = {
      "normalized_convolution",
      "confidence_pool",
      "convolution",
      "dense",
      "upsample_nearest",
      "upsample_bilinear",
      "convex_upsample",
      "average_pool",
      "global_average_pool",
      "relu",
      "tanh",
      "sigmoid",
      "softplus",
      "exp",
      "log",
      "leaky_relu",
      "clamp",
      "affine",
      "add",
      "multiply",
      "concatenate",
      "slice",
      "median_log",
      "latitude_sine",
  };
  return kNames[operation.index()];
}

Shape ShapeFor(const Tensor& tensor, int height, int width) {
  if (tensor.extent.is_single) return {tensor.channels, 1, 1};
  return {tensor.channels, Scaled(height, tensor.extent.halvings),
          Scaled(width, tensor.extent.halvings)};
}

int KernelSize(const Graph& graph, const Node& node) {
  return graph.weights[static_cast<std::size_t>(node.weights.front())].shape[3];
}

std::int64_t CountParameters(const Graph& graph) {
  std::int64_t count = 0;
  for (const Weight& weight : graph.weights)
    count += static_cast<std::int64_t>(weight.values.size());
  return count;
}

std::int64_t MultiplyAdds(const Graph& graph, const Node& node, int height, int width) {
  if (node.weights.empty()) return 0;
  const auto weight = static_cast<std::size_t>(node.weights.front());
  const auto output = static_cast<std::size_t>(node.outputs.front());
  const Shape shape = ShapeFor(graph.tensors[output], height, width);
  const auto per_pixel = static_cast<std::int64_t>(graph.weights[weight].values.size());
  const int sums = std::holds_alternative<NormalizedConvolutionOp>(node.operation) ? 2 : 1;
  return sums * per_pixel * shape.height * shape.width;
}

}  // namespace orb360::nn
