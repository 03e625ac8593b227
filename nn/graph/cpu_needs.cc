#include "nn/graph/cpu_needs.h"

#include <cstddef>
#include <vector>

#include "nn/kernels/convex_upsample.h"
#include "nn/kernels/convolution.h"
#include "nn/kernels/upsample.h"

namespace orb360::nn {
namespace {

using Layouts = PortNeeds::Layouts;

constexpr PortNeeds kPlanar{.layouts = Layouts::kPlanar};
constexpr PortNeeds kFree{};
constexpr PortNeeds kTied{.is_tied = true};

constexpr PortNeeds WithHalo(PortNeeds needs, int halo) {
  needs.halo = halo;
  return needs;
}

class Needs {
 public:
  Needs(const Graph& graph, const FusedNode& fused) : graph_(graph), fused_(fused) {}

  NodeNeeds operator()(const NormalizedConvolutionOp&) const {
    return {std::vector<PortNeeds>(fused_.node.inputs.size(), kPlanar),
            std::vector<PortNeeds>(fused_.node.outputs.size(), kPlanar),
            {}};
  }
  NodeNeeds operator()(const ConfidencePoolOp&) const {
    return {{kPlanar, kPlanar}, {kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const ConvolutionOp&) const {
    const int inputs = graph_.tensors[static_cast<std::size_t>(fused_.node.inputs[0])].channels;
    const PortNeeds input{
        .layouts = inputs <= kMaxPlanarChannels ? Layouts::kPlanar : Layouts::kBlocked,
        .halo = KernelSize(graph_, fused_.node) / 2};
    if (!fused_.adds_residual) return {{input}, {kTied}, {}};
    return {{input, kTied}, {kTied}, {1}};
  }
  NodeNeeds operator()(const DenseOp&) const { return {{kFree}, {kFree}, {}}; }
  NodeNeeds operator()(const GlobalAveragePoolOp&) const { return {{kFree}, {kFree}, {}}; }
  NodeNeeds operator()(const UpsampleNearestOp&) const { return {{kTied}, {kTied}, {}}; }
  NodeNeeds operator()(const UpsampleBilinearOp&) const {
    return {{WithHalo(kTied, kUpsampleBilinearHalo)}, {kTied}, {}};
  }
  NodeNeeds operator()(const ConvexUpsampleOp&) const {
    return {{WithHalo(kPlanar, kConvexUpsampleHalo), kPlanar}, {kPlanar}, {}};
  }
  NodeNeeds operator()(const AveragePoolOp&) const { return {{kTied}, {kTied}, {}}; }
  NodeNeeds operator()(const AddOp&) const { return {{kTied, kTied}, {kTied}, {0, 1}}; }
  NodeNeeds operator()(const MultiplyOp&) const { return {{kTied, kTied}, {kTied}, {0, 1}}; }
  NodeNeeds operator()(const MedianLogOp&) const {
    return {{kPlanar, kPlanar}, {kPlanar, kPlanar, kPlanar}, {}};
  }
  NodeNeeds operator()(const LatitudeSineOp&) const { return {{kFree}, {kFree}, {}}; }
  /// Functions of one number.
  template <typename Elementwise>
  NodeNeeds operator()(const Elementwise&) const {
    return {{kTied}, {kTied}, {0}};
  }

 private:
  const Graph& graph_;
  const FusedNode& fused_;
};

}  // namespace

NodeNeeds CpuNeedsOf(const Graph& graph, const FusedNode& node) {
  return std::visit(Needs(graph, node), node.node.operation);
}

}  // namespace orb360::nn
