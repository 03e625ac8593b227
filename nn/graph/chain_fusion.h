#pragma once

#include <vector>

#include "nn/graph/fusion.h"
#include "nn/graph/graph.h"

namespace orb360::nn {

/// Merges what surrounds normalized convolutions into them (FusedNode::chain, doubled, pool): other
/// normalized convolutions that alone read what they write, concatenations and nearest up-sampling
/// before them, confidence pooling behind. Nodes whose results nobody reads any more stay.
std::vector<FusedNode> MergeChains(const Graph& graph, std::vector<FusedNode> nodes);

}  // namespace orb360::nn
