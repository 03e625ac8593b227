#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// What a node must compute and move, whatever computes it.
struct LayerCost {
  /// Multiplications and additions: two for each product with a weight (MultiplyAdds), and one for
  /// each element of the result.
  std::int64_t operations = 0;
  /// Bytes of inputs, outputs and weights, each read or written once, as 32-bit floats.
  std::int64_t bytes = 0;
};

/// Returns the cost of each node for an image of that size. Concatenations and slices, which are
/// views, cost nothing.
std::vector<LayerCost> LayerCosts(const Graph& graph, std::span<const FusedNode> nodes, int height,
                                  int width);

/// Returns the least time of a layer, s, on a processor of that speed (operations/s) and bandwidth
/// of memory (bytes/s): the longer one of computing and moving. (Williams, Waterman, Patterson:
/// Roofline, CACM 2009.)
double RooflineSeconds(const LayerCost& cost, double speed, double bandwidth);

}  // namespace orb360::nn
