#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nn/graph/fusion.h"
#include "nn/graph/graph.h"
#include "nn/tensor.h"

namespace orb360::nn {

/// How a kernel needs one of its inputs to lie, or leaves one of its outputs.
struct PortNeeds {
  enum class Layouts : std::uint8_t { kPlanar, kBlocked, kEither };
  enum class Types : std::uint8_t { kFloat, kBFloat16, kEither };

  Layouts layouts = Layouts::kEither;
  Types types = Types::kFloat;
  /// All tied ports of a node have the same layout and type.
  bool is_tied = false;
  /// Of an input: pixels of halo that the kernel fills and reads.
  int halo = 0;
};

struct NodeNeeds {
  std::vector<PortNeeds> inputs;
  std::vector<PortNeeds> outputs;
  /// Inputs whose memory the first output may take over, where both have the same format.
  std::vector<int> replaceable;
};

/// One kernel with its packed weights, for tensors of the formats that were asked for. Runs from
/// several threads at once, without allocating.
struct Step {
  using Run =
      std::function<void(std::span<const TensorView> inputs, std::span<const TensorView> outputs,
                         std::span<std::byte> scratch)>;
  Run run;
  /// Of memory aligned to kAlignment that a run needs for itself.
  std::size_t scratch_bytes = 0;
};

/// What runs on a kind of processor. The only way from a graph to kernels: whoever implements it
/// can execute every network. Concatenation and slices need no kernel but MakeCopy's.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  virtual NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const = 0;
  /// One for each node, for pictures of that size; empty ones for concatenations and slices.
  virtual std::vector<Step> MakeSteps(const Graph& graph, std::span<const FusedNode> nodes,
                                      int height, int width) const = 0;
  /// Copies `count` channels of the only input to the only output, between any formats.
  virtual Step MakeCopy(int from_first, int to_first, int count) const = 0;
};

}  // namespace orb360::nn
