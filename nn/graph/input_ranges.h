#pragma once

#include <string_view>

#include <orb360/nn/graph/graph.h>

namespace orb360::nn {

/// Adds the ranges of convolutions' inputs to a graph: `json` is the text of `/quantization` in
/// docs/formats/network.md. It need not be trusted: whatever the document does not allow throws
/// UserError with one line that names the node and the reason.
void AddInputRanges(std::string_view json, Graph* graph);

}  // namespace orb360::nn
