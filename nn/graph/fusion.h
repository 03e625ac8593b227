#pragma once

#include <vector>

#include "nn/graph/graph.h"

namespace orb360::nn {

/// A node and what is done to its result in the same pass: y = activation(node + residual), where
/// the activation is y > 0 ? y : slope * y.
struct FusedNode {
  Node node;  // a residual is the last of its inputs; its output is what the last part wrote
  bool adds_residual = false;
  float slope = 1;
};

/// The graph's nodes in an order they can run in, with additions and activations merged into the
/// convolutions before them where nobody else needs what lies between, and without nodes that no
/// output depends on.
std::vector<FusedNode> FuseNodes(const Graph& graph);

/// The graph's nodes as they are.
std::vector<FusedNode> KeepNodes(const Graph& graph);

}  // namespace orb360::nn
