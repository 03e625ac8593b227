#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "nn/graph/fusion.h"
#include "nn/graph/program.h"
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

struct Lowered;

/// The interface to one kind of processor, and the only connection between a graph and kernels:
/// whoever implements it can execute every network. Concatenation and slices need no kernel but
/// that of a copy of channels.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  /// Returns the graph's nodes, merged where the kernels do several in one pass.
  virtual std::vector<FusedNode> Fuse(const Graph& graph) const { return FuseNodes(graph); }
  virtual NodeNeeds NeedsOf(const Graph& graph, const FusedNode& node) const = 0;
  /// Returns the program of `lowered`, made of `nodes` for images of that size: weights packed,
  /// memory planned. Throws DeviceError where a device has too little memory, fails or cannot do
  /// what `options` asks for.
  virtual std::unique_ptr<const Program> MakeProgram(const Graph& graph,
                                                     std::span<const FusedNode> nodes,
                                                     Lowered lowered, int height, int width,
                                                     const ProgramOptions& options) const = 0;
};

}  // namespace orb360::nn
