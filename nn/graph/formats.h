#pragma once

#include <span>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// Layout and data type of a tensor, without its size and halo.
struct Format {
  Layout layout = Layout::kPlanar;
  DataType type = DataType::kFloat;
  friend bool operator==(const Format&, const Format&) = default;
};

/// Collects the needs that a backend states for each node. Concatenations and slices work in any
/// format.
std::vector<NodeNeeds> CollectNeeds(const Graph& graph, std::span<const FusedNode> nodes,
                                    const Backend& backend);

/// Chooses the format in which each tensor of the graph is written: one that its writer supports
/// and most of its readers want. For a reader that needs another format, the tensor is copied.
std::vector<Format> ChooseFormats(const Graph& graph, std::span<const FusedNode> nodes,
                                  std::span<const NodeNeeds> needs);

/// Returns true if channels `first` to `first + count - 1` of a tensor are a tensor by themselves.
bool IsViewOfChannels(const Format& format, int channels, int first, int count);

}  // namespace orb360::nn
