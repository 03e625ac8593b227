#pragma once

#include <vector>

#include "nn/graph/graph.h"

namespace orb360::nn {

/// Channels and extents of what `node` writes, from what it reads: its inputs in graph.tensors and
/// its weights in graph.weights, both of the number that the operation takes. Throws UserError with
/// the reason alone where the operation cannot take them at every size of picture the graph allows,
/// or where its attributes or the values of its weights make no sense.
std::vector<Tensor> InferOutputs(const Graph& graph, const Node& node);

}  // namespace orb360::nn
