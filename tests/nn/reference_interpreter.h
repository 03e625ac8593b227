#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// What a node computes of its inputs: loops in double precision, written from
/// docs/formats/network.md and sharing nothing with the kernels.
struct NodeResult {
  std::vector<PlainImage> outputs;
  /// By output and element: the sum of the absolute values of what is added up there, on which the
  /// rounding errors of any order of addition depend. At least the element's absolute value.
  std::vector<PlainImage> magnitudes;
};
NodeResult InterpretNode(const Graph& graph, const Node& node,
                         const std::vector<const PlainImage*>& inputs);

/// Every tensor of the graph, by name. `inputs` in the graph's order.
std::map<std::string, PlainImage> Interpret(const Graph& graph,
                                            const std::vector<PlainImage>& inputs);

}  // namespace orb360::nn
