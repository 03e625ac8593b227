#pragma once

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// CpuBackend::NeedsOf without the kernels. `precision` is the type in which convolutions multiply.
NodeNeeds CpuNeedsOf(const Graph& graph, const FusedNode& node, DataType precision);

/// Returns the type in which a convolution multiplies when `precision` is requested. An input of
/// few channels is multiplied as floats if the result has few channels too or is added to another
/// tensor. In 8 bits only convolutions multiply that have many channels and a range of inputs.
DataType ConvolutionType(const Graph& graph, const FusedNode& node, DataType precision);

}  // namespace orb360::nn
