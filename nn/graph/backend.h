#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nn/graph/fusion.h"
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {

/// The format in which a kernel needs one of its inputs, or leaves one of its outputs.
struct PortNeeds {
  enum class Layouts : std::uint8_t { kPlanar, kBlocked, kEither };
  enum class Types : std::uint8_t { kFloat, kBFloat16, kEither };

  Layouts layouts = Layouts::kEither;
  Types types = Types::kFloat;
  /// All tied ports of a node have the same layout and type.
  bool is_tied = false;
  /// For an input: pixels of halo that the kernel fills and reads.
  int halo = 0;
};

struct NodeNeeds {
  std::vector<PortNeeds> inputs;
  std::vector<PortNeeds> outputs;
  /// Inputs whose memory the first output may reuse if both have the same format.
  std::vector<int> replaceable;
};

/// One kernel with its packed weights, for tensors of the requested formats. It can run on several
/// threads at once and does not allocate.
struct Step {
  using Run =
      std::function<void(std::span<const TensorView> inputs, std::span<const TensorView> outputs,
                         std::span<std::byte> scratch)>;
  Run run;
  /// Bytes of memory, aligned to kAlignment, that one run needs for itself.
  std::size_t scratch_bytes = 0;
};

/// The interface to one kind of processor, and the only connection between a graph and kernels:
/// whoever implements it can execute every network. Concatenation and slices need only the kernel
/// of MakeCopy.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  virtual NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const = 0;
  /// Returns one step for each node, for images of that size. The steps of concatenations and
  /// slices are empty.
  virtual std::vector<Step> MakeSteps(const Graph& graph, std::span<const FusedNode> nodes,
                                      int height, int width) const = 0;
  /// Returns a step that copies `count` channels of its only input to its only output, between any
  /// formats.
  virtual Step MakeCopy(int from_first, int to_first, int count) const = 0;
};

}  // namespace orb360::nn
