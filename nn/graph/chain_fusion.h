#pragma once

#include <vector>

#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Merges the neighbours of normalized convolutions into them (FusedNode::chain, doubled, pool):
/// other normalized convolutions that are the only readers of their results, concatenations and
/// nearest up-sampling before them, and confidence pooling after them. Nodes whose results are no
/// longer read remain.
std::vector<FusedNode> MergeChains(const Graph& graph, std::vector<FusedNode> nodes);

}  // namespace orb360::nn
