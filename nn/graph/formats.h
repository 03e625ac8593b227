#pragma once

#include <span>
#include <vector>

#include "nn/graph/backend.h"
#include "nn/graph/fusion.h"
#include "nn/graph/graph.h"
#include "nn/tensor.h"

namespace orb360::nn {

/// How a tensor lies in memory, its size and halo left aside.
struct Format {
  Layout layout = Layout::kPlanar;
  DataType type = DataType::kFloat;
  friend bool operator==(const Format&, const Format&) = default;
};

/// What a backend says of each node; concatenations and slices work in any format.
std::vector<NodeNeeds> CollectNeeds(const Graph& graph, std::span<const FusedNode> nodes,
                                    const Backend& backend);

/// The format in which each tensor of the graph is written: what its writer can and most of its
/// readers want. Where a reader needs another one, the tensor is copied for it.
std::vector<Format> ChooseFormats(const Graph& graph, std::span<const FusedNode> nodes,
                                  std::span<const NodeNeeds> needs);

/// True when channels `first` to `first + count - 1` of a tensor are a tensor themselves.
bool IsViewOfChannels(const Format& format, int channels, int first, int count);

}  // namespace orb360::nn
