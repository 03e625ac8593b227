#pragma once

#include <string_view>
#include <vector>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Builds a graph from the JSON text of docs/formats/network.md and its weights, each of which has
/// as many values as its shape says and a name of its own. Neither needs to be trusted: whatever
/// the document does not allow throws UserError with one line that names the node and the reason.
Graph ParseGraph(std::string_view json, std::vector<Weight> weights);

}  // namespace orb360::nn
