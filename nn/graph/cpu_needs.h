#pragma once

#include "nn/graph/backend.h"

namespace orb360::nn {

/// CpuBackend::NeedsOf without the kernels themselves.
NodeNeeds CpuNeedsOf(const Graph& graph, const FusedNode& node);

}  // namespace orb360::nn
