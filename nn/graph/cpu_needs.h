#pragma once

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include "nn/graph/graph.h"
#include "nn/tensor.h"

namespace orb360::nn {

/// CpuBackend::NeedsOf without the kernels themselves. `precision`: what convolutions multiply.
NodeNeeds CpuNeedsOf(const Graph& graph, const FusedNode& node, DataType precision);

/// What a convolution multiplies where `precision` is asked for: pictures become floats where their
/// few channels make few channels again, or are added to something.
DataType ConvolutionType(const Graph& graph, const FusedNode& node, DataType precision);

}  // namespace orb360::nn
