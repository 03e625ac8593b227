#include "nn/graph/fusion.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "nn/graph/chain_fusion.h"

namespace orb360::nn {
namespace {

constexpr int kNobody = -1;
constexpr int kSeveral = -2;  // or an output of the graph

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

/// Returns the slope of an activation that a convolution can apply in the same pass.
std::optional<float> SlopeOf(const Operation& operation) {
  if (std::holds_alternative<ReluOp>(operation)) return 0.0f;
  if (const auto* relu = std::get_if<LeakyReluOp>(&operation)) return relu->slope;
  return {};
}

class ConvolutionFusion {
 public:
  explicit ConvolutionFusion(const Graph& graph)
      : graph_(graph),
        writer_(graph.tensors.size(), kNobody),
        reader_(graph.tensors.size(), kNobody),
        is_merged_(graph.nodes.size()) {
    const auto read = [&](int tensor, int reader) {
      int& known = reader_[Index(tensor)];
      known = known == kNobody ? reader : kSeveral;
    };
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
      for (const int tensor : graph.nodes[i].inputs) read(tensor, static_cast<int>(i));
      for (const int tensor : graph.nodes[i].outputs) writer_[Index(tensor)] = static_cast<int>(i);
    }
    for (const Graph::Output& output : graph.outputs) read(output.tensor, kSeveral);
  }

  std::vector<FusedNode> Run() {
    // A fused node runs where its last part was: everything that it reads has been written by then.
    std::vector<std::optional<FusedNode>> at(graph_.nodes.size());
    for (std::size_t i = 0; i < graph_.nodes.size(); ++i) {
      if (is_merged_[i]) continue;
      FusedNode fused{.node = graph_.nodes[i]};
      std::size_t position = i;
      if (std::holds_alternative<ConvolutionOp>(fused.node.operation)) {
        MergeAddition(&fused, &position);
        MergeActivation(&fused, &position);
      }
      at[position] = std::move(fused);
    }
    std::vector<FusedNode> nodes;
    for (std::optional<FusedNode>& node : at) {
      if (node) nodes.push_back(std::move(*node));
    }
    return nodes;
  }

 private:
  /// Returns the only reader of the node's result, if there is exactly one.
  int OnlyReader(const FusedNode& fused) const {
    return reader_[Index(fused.node.outputs.front())];
  }

  void Merge(int reader, FusedNode* fused, std::size_t* position) {
    fused->node.outputs = graph_.nodes[Index(reader)].outputs;
    is_merged_[Index(reader)] = true;
    *position = Index(reader);
  }

  void MergeAddition(FusedNode* fused, std::size_t* position) {
    const int reader = OnlyReader(*fused);
    if (reader < 0 || is_merged_[Index(reader)]) return;
    const Node& addition = graph_.nodes[Index(reader)];
    if (!std::holds_alternative<AddOp>(addition.operation)) return;
    const bool is_first = addition.inputs[0] == fused->node.outputs.front();
    const int other = addition.inputs[is_first ? 1 : 0];
    // If both summands are results of convolutions, the later one adds.
    const int writer = writer_[Index(other)];
    const bool is_for_the_other =
        writer > static_cast<int>(*position) && reader_[Index(other)] == reader &&
        std::holds_alternative<ConvolutionOp>(graph_.nodes[Index(writer)].operation);
    if (is_for_the_other) return;
    fused->node.inputs.push_back(other);
    fused->adds_residual = true;
    Merge(reader, fused, position);
  }

  void MergeActivation(FusedNode* fused, std::size_t* position) {
    const int reader = OnlyReader(*fused);
    if (reader < 0 || is_merged_[Index(reader)]) return;
    const std::optional<float> slope = SlopeOf(graph_.nodes[Index(reader)].operation);
    if (!slope) return;
    fused->slope = *slope;
    Merge(reader, fused, position);
  }

  const Graph& graph_;
  std::vector<int> writer_;  // node of each tensor
  std::vector<int> reader_;  // likewise, or how many there are
  std::vector<bool> is_merged_;
};

/// Returns the nodes on which the graph's outputs depend, in order.
std::vector<FusedNode> Needed(const Graph& graph, std::vector<FusedNode> nodes) {
  std::vector<bool> is_tensor_needed(graph.tensors.size());
  for (const Graph::Output& output : graph.outputs) is_tensor_needed[Index(output.tensor)] = true;
  std::vector<FusedNode> needed;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const bool is_needed = std::ranges::any_of(
        nodes[i].node.outputs, [&](int tensor) { return is_tensor_needed[Index(tensor)]; });
    if (!is_needed) continue;
    for (const int tensor : nodes[i].node.inputs) is_tensor_needed[Index(tensor)] = true;
    needed.push_back(std::move(nodes[i]));
  }
  std::ranges::reverse(needed);
  return needed;
}

}  // namespace

std::vector<FusedNode> FuseNodes(const Graph& graph) {
  return Needed(graph, MergeChains(graph, ConvolutionFusion(graph).Run()));
}

std::vector<FusedNode> FuseConvolutions(const Graph& graph) {
  return Needed(graph, ConvolutionFusion(graph).Run());
}

std::vector<FusedNode> KeepNodes(const Graph& graph) {
  std::vector<FusedNode> nodes;
  for (const Node& node : graph.nodes) nodes.push_back({.node = node});
  return nodes;
}

}  // namespace orb360::nn
