#pragma once

#include <vector>

#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Every node against double precision on the numbers that the executor gave it: what is allowed is
/// then the rounding of that node alone.
void ExpectEveryNodeRight(const Graph& graph, const std::vector<PlainImage>& inputs,
                          ExecutorOptions options);

}  // namespace orb360::nn
