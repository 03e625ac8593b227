#include "nn/graph/layer_cost.h"

#include <algorithm>
#include <variant>

namespace orb360::nn {
namespace {

std::int64_t Elements(const Graph& graph, int tensor, int height, int width) {
  const Shape shape = ShapeFor(graph.tensors[static_cast<std::size_t>(tensor)], height, width);
  return std::int64_t{shape.channels} * shape.height * shape.width;
}

LayerCost CostOf(const Graph& graph, const Node& node, int height, int width) {
  const bool is_view = std::holds_alternative<ConcatenateOp>(node.operation) ||
                       std::holds_alternative<SliceOp>(node.operation);
  if (is_view) return {};
  std::int64_t moved = 0;
  for (const int tensor : node.inputs) moved += Elements(graph, tensor, height, width);
  LayerCost cost{.operations = 2 * MultiplyAdds(graph, node, height, width)};
  for (const int tensor : node.outputs) {
    const std::int64_t written = Elements(graph, tensor, height, width);
    moved += written;
    cost.operations += written;
  }
  for (const int weight : node.weights) {
    moved +=
        static_cast<std::int64_t>(graph.weights[static_cast<std::size_t>(weight)].values.size());
  }
  cost.bytes = moved * static_cast<std::int64_t>(sizeof(float));
  return cost;
}

}  // namespace

std::vector<LayerCost> LayerCosts(const Graph& graph, std::span<const FusedNode> nodes, int height,
                                  int width) {
  std::vector<LayerCost> costs;
  for (const FusedNode& fused : nodes) costs.push_back(CostOf(graph, fused.node, height, width));
  return costs;
}

double RooflineSeconds(const LayerCost& cost, double speed, double bandwidth) {
  return std::max(static_cast<double>(cost.operations) / speed,
                  static_cast<double>(cost.bytes) / bandwidth);
}

}  // namespace orb360::nn
