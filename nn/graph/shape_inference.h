#pragma once

#include <vector>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Returns channels and extents of the outputs of `node`. Its inputs are in graph.tensors and its
/// weights in graph.weights, both of the number that the operation takes. Throws UserError with the
/// reason only, if the operation cannot take them at every image size that the graph allows, or if
/// its attributes or the values of its weights are invalid.
std::vector<Tensor> InferOutputs(const Graph& graph, const Node& node);

}  // namespace orb360::nn
