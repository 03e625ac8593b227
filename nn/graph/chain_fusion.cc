#include "nn/graph/chain_fusion.h"

#include <cstddef>
#include <optional>
#include <utility>

#include "nn/kernels/normalized_chain.h"

namespace orb360::nn {
namespace {

constexpr int kNobody = -1;
constexpr int kOutput = -2;  // an output of the graph

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

template <typename Op>
bool Is(const FusedNode& fused) {
  return std::holds_alternative<Op>(fused.node.operation);
}

/// The tensors of a value and its confidence.
struct Pair {
  int x = 0;
  int c = 0;
};

class ChainFusion {
 public:
  ChainFusion(const Graph& graph, std::vector<FusedNode> nodes)
      : graph_(graph),
        nodes_(std::move(nodes)),
        is_merged_(nodes_.size()),
        writer_(graph.tensors.size(), kNobody),
        readers_(graph.tensors.size()) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (const int tensor : nodes_[i].node.inputs) {
        readers_[Index(tensor)].push_back(static_cast<int>(i));
      }
      for (const int tensor : nodes_[i].node.outputs) {
        writer_[Index(tensor)] = static_cast<int>(i);
      }
    }
    for (const Graph::Output& output : graph.outputs) {
      readers_[Index(output.tensor)].push_back(kOutput);
    }
  }

  std::vector<FusedNode> Run() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!is_merged_[i] && Is<NormalizedConvolutionOp>(nodes_[i])) MergeIntoNext(i);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (is_merged_[i] || !Is<NormalizedConvolutionOp>(nodes_[i])) continue;
      SplitInputs(&nodes_[i]);
      MergePool(&nodes_[i]);
    }
    std::vector<FusedNode> left;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!is_merged_[i]) left.push_back(std::move(nodes_[i]));
    }
    return left;
  }

 private:
  static Pair OutputsOf(const FusedNode& fused) {
    return {fused.node.outputs[0], fused.node.outputs[1]};
  }

  /// Merges node i into the next one. The chain runs where its last link was: everything that it
  /// reads has been written by then.
  void MergeIntoNext(std::size_t i) {
    const Pair result = OutputsOf(nodes_[i]);
    const std::vector<int>& readers = readers_[Index(result.x)];
    if (readers.size() != 1 || readers[0] == kOutput || readers_[Index(result.c)] != readers) {
      return;
    }
    FusedNode& next = nodes_[Index(readers[0])];
    const bool continues = Is<NormalizedConvolutionOp>(next) &&
                           next.node.inputs == std::vector<int>{result.x, result.c} &&
                           nodes_[i].chain.size() + 2 <= NormalizedChain::kMaxLayers;
    if (!continues) return;
    FusedNode chain = std::move(nodes_[i]);
    chain.chain.push_back(next.node);
    chain.node.outputs = next.node.outputs;
    next = std::move(chain);
    is_merged_[i] = true;
  }

  template <typename Op>
  const Node* WriterOf(int tensor) const {
    const int writer = writer_[Index(tensor)];
    if (writer < 0 || is_merged_[Index(writer)] || !Is<Op>(nodes_[Index(writer)])) return nullptr;
    return &nodes_[Index(writer)].node;
  }

  /// Lets the node read the concatenated and up-sampled tensors themselves in place of the result.
  void SplitInputs(FusedNode* fused) const {
    const std::vector<Pair> parts = PartsOf({fused->node.inputs[0], fused->node.inputs[1]});
    fused->node.inputs.clear();
    for (Pair part : parts) {
      const Node* const x = WriterOf<UpsampleNearestOp>(part.x);
      const Node* const c = WriterOf<UpsampleNearestOp>(part.c);
      const bool is_doubled = x != nullptr && c != nullptr;
      if (is_doubled) part = {x->inputs[0], c->inputs[0]};
      fused->node.inputs.push_back(part.x);
      fused->node.inputs.push_back(part.c);
      fused->doubled.push_back(is_doubled);
    }
  }

  std::vector<Pair> PartsOf(Pair whole) const {
    const Node* const x = WriterOf<ConcatenateOp>(whole.x);
    const Node* const c = WriterOf<ConcatenateOp>(whole.c);
    const bool can_split = x != nullptr && c != nullptr && x->inputs.size() == c->inputs.size() &&
                           x->inputs.size() <= FusedNode::kMaxPairs;
    if (!can_split) return {whole};
    std::vector<Pair> parts;
    for (std::size_t i = 0; i < x->inputs.size(); ++i) {
      const Pair part{x->inputs[i], c->inputs[i]};
      if (graph_.tensors[Index(part.x)].channels != graph_.tensors[Index(part.c)].channels) {
        return {whole};
      }
      parts.push_back(part);
    }
    return parts;
  }

  void MergePool(FusedNode* fused) {
    const Pair result = OutputsOf(*fused);
    for (const int reader : readers_[Index(result.x)]) {
      if (reader == kOutput) continue;
      const FusedNode& pool = nodes_[Index(reader)];
      if (is_merged_[Index(reader)] || !Is<ConfidencePoolOp>(pool) ||
          pool.node.inputs != std::vector<int>{result.x, result.c}) {
        continue;
      }
      fused->pool = std::get<ConfidencePoolOp>(pool.node.operation);
      fused->node.outputs.insert(fused->node.outputs.end(), pool.node.outputs.begin(),
                                 pool.node.outputs.end());
      is_merged_[Index(reader)] = true;
      return;
    }
  }

  const Graph& graph_;
  std::vector<FusedNode> nodes_;
  std::vector<bool> is_merged_;
  std::vector<int> writer_;                // node of each tensor
  std::vector<std::vector<int>> readers_;  // nodes of each tensor
};

}  // namespace

std::vector<FusedNode> MergeChains(const Graph& graph, std::vector<FusedNode> nodes) {
  return ChainFusion(graph, std::move(nodes)).Run();
}

}  // namespace orb360::nn
