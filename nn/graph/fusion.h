#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// A node and the operations that are done in the same pass.
struct FusedNode {
  Node node;  // with the inputs and outputs of the whole

  /// For a convolution: y = activation(node + residual), where the residual is the last input and
  /// the activation is y > 0 ? y : slope * y.
  bool adds_residual = false;
  float slope = 1;

  /// For a normalized convolution: further normalized convolutions, each applied to the result of
  /// the previous one.
  std::vector<Node> chain = {};
  /// The node reads the concatenation of at most kMaxPairs pairs x, c. `doubled` states for each
  /// pair whether every pixel stands for 2x2. If it is empty, there is one pair, which is not
  /// doubled.
  static constexpr std::size_t kMaxPairs = 8;
  std::vector<bool> doubled = {};
  /// The third and fourth outputs are the result of this operation on the first two.
  std::optional<ConfidencePoolOp> pool = {};
};

/// Returns the graph's nodes in an order in which they can run. Additions and activations are
/// merged into the convolutions before them if no other node needs the results between; normalized
/// convolutions are merged with their neighbours (chain_fusion.h); nodes on which no output depends
/// are removed.
std::vector<FusedNode> FuseNodes(const Graph& graph);

/// The same without the normalized convolutions' neighbours.
std::vector<FusedNode> FuseConvolutions(const Graph& graph);

/// Returns the graph's nodes unchanged.
std::vector<FusedNode> KeepNodes(const Graph& graph);

}  // namespace orb360::nn
