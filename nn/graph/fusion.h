#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "nn/graph/graph.h"

namespace orb360::nn {

/// A node and what is done in the same pass.
struct FusedNode {
  Node node;  // with the inputs and outputs of the whole

  /// A convolution's: y = activation(node + residual), where the residual is the last of the inputs
  /// and the activation is y > 0 ? y : slope * y.
  bool adds_residual = false;
  float slope = 1;

  /// A normalized convolution's: others that follow, each on what the one before it gives.
  std::vector<Node> chain = {};
  /// It reads the concatenation of pairs x, c: at most so many. `doubled`: by pair, whether every
  /// pixel stands for 2x2. Empty: one pair, which is not.
  static constexpr std::size_t kMostPairs = 8;
  std::vector<bool> doubled = {};
  /// The third and fourth output are what this makes of the first two.
  std::optional<ConfidencePoolOp> pool = {};
};

/// The graph's nodes in an order they can run in, with additions and activations merged into the
/// convolutions before them where nobody else needs what lies between, normalized convolutions
/// merged with what surrounds them (chain_fusion.h), and without nodes that no output depends on.
std::vector<FusedNode> FuseNodes(const Graph& graph);

/// The graph's nodes as they are.
std::vector<FusedNode> KeepNodes(const Graph& graph);

}  // namespace orb360::nn
